// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light of one point against sums over all directions in double, and closed forms.
#include "simulator/render/blurred/stripe_response.h"

#include <cmath>
#include <complex>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/simulator/render/blurred/blurred_bench.h"

namespace glint::blurred_test {
namespace {

using Eigen::Vector3d;

TunnelSettings semicylinder() {
  return {.shape = TunnelSettings::Shape::kSemicylinder,
          .radius_mm = 100.0,
          .length_mm = 400.0,
          .slot_mm = 16.0,
          .period_mm = 24.0};
}

/// A point seen from above by a camera a little aside, its normal tilted.
BlurredPoint tilted_point() {
  const Vector3d point_mm(5.0, -4.0, 3.0);
  const Vector3d normal = Vector3d(0.05, 0.2, 1.0).normalized();
  const Vector3d to_viewer = (Vector3d(20.0, 10.0, 400.0) - point_mm).normalized();
  return {.point_mm = point_mm,
          .to_viewer = to_viewer,
          .mirrored = 2.0 * normal.dot(to_viewer) * normal - to_viewer};
}

/// The numbers of StripeResponse::at() as a sum over directions, on a grid of slopes of facets
/// whose rings hold less of the distribution the steeper they are: one of 1 / rings of it would
/// cross the wall's edge as a whole.
std::vector<double> summed(const TunnelSettings& settings,
                           const SurfaceMaterial& material,
                           double alpha,
                           const BlurredPoint& point,
                           double phase_mm,
                           const HarmonicList& harmonics) {
  constexpr int kRings = 300;
  constexpr int kTurns = 400;
  const Tunnel tunnel(settings);
  const ShadingFrame frame =
      frame_at((point.mirrored + point.to_viewer).normalized(), Vector3d::UnitX());
  const LocalDirection viewer = frame.to_local(point.to_viewer);
  std::vector<double> numbers(2 + 2 * static_cast<std::size_t>(harmonics.count), 0.0);
  for (int i = 0; i < kRings; ++i) {
    const double beyond = std::pow(1.0 - (i + 0.5) / kRings, 2);  // of facets that are steeper
    const double share = (std::pow(1.0 - static_cast<double>(i) / kRings, 2) -
                          std::pow(1.0 - (i + 1.0) / kRings, 2)) /
                         kTurns;
    const double slope = alpha * std::sqrt((1.0 - beyond) / beyond);
    for (int j = 0; j < kTurns; ++j) {
      const double turn = 2.0 * kPi * (j + 0.5) / kTurns;
      const double z = 1.0 / std::sqrt(1.0 + slope * slope);
      const LocalDirection facet = {slope * z * std::cos(turn), slope * z * std::sin(turn), z};
      const LocalDirection light = reflect(viewer, facet);
      if (light.z <= 0.0 || dot(viewer, facet) <= 0.0) {
        continue;
      }
      const Vector3d to_light =
          light.x * frame.tangent + light.y * frame.bitangent + light.z * frame.normal;
      const auto hit = tunnel.hit({point.point_mm, to_light});
      if (!hit || std::abs(hit->point_mm.x()) > 0.5 * settings.length_mm) {
        continue;
      }
      // Facets have the density D cos; directions are 4 cos(viewer, facet) times as many.
      const double solid_angle =
          4.0 * dot(viewer, facet) * share / (ggx_distribution({alpha, alpha}, facet) * z);
      const double law = settings.cosine_law ? std::abs(hit->normal.dot(to_light)) : 1.0;
      const double arriving =
          law * solid_angle * evaluate(material.plain(), viewer, light).value[0];
      const double dark = tunnel.dark_at(hit->point_mm.tail<2>());
      const double phase = (hit->point_mm.x() * std::cos(settings.orientation_rad) +
                            hit->arc_mm * std::sin(settings.orientation_rad) - phase_mm) /
                           settings.period_mm;
      numbers[0] += dark * arriving;
      numbers[1] += (1.0 - dark) * arriving;
      for (int k = 0; k < harmonics.count; ++k) {
        const std::complex<double> wave =
            std::polar((1.0 - dark) * arriving, 2.0 * kPi * harmonics.number(k) * phase);
        numbers[2 + 2 * static_cast<std::size_t>(k)] += wave.real();
        numbers[3 + 2 * static_cast<std::size_t>(k)] += wave.imag();
      }
    }
  }
  return numbers;
}

std::vector<float> response_at(const TunnelSettings& settings,
                               const SurfaceMaterial& material,
                               const BlurredPoint& point,
                               double phase_mm,
                               const HarmonicList& harmonics) {
  const Tunnel tunnel(settings);
  const auto metal = conductor_numbers(material.plain());
  const StripeResponse response(tunnel, metal.value(), 0.0, harmonics);
  std::vector<float> numbers(response.size());
  response.at(point, phase_mm, numbers);
  return numbers;
}

TEST(StripeResponse, IsTheSumOverAllDirections) {
  TunnelSettings oblique = semicylinder();
  oblique.orientation_rad = 0.9;
  TunnelSettings along = semicylinder();
  along.orientation_rad = 0.5 * kPi;
  TunnelSettings grey = semicylinder();
  grey.shape = TunnelSettings::Shape::kSuperellipse;
  grey.dark_reflectance = 0.7;
  grey.cosine_law = true;
  TunnelSettings flat = semicylinder();
  flat.shape = TunnelSettings::Shape::kFlat;
  flat.opening_rad = 0.8;
  TunnelSettings free = semicylinder();
  free.shape = TunnelSettings::Shape::kFree;
  free.control_mm = {70.0, 90.0, 120.0, 110.0, 100.0};
  const std::vector<std::pair<const char*, TunnelSettings>> cases = {
      {"semicylinder", semicylinder()},
      {"oblique", oblique},
      {"along", along},
      {"grey superellipse", grey},
      {"flat", flat},
      {"free", free}};
  const HarmonicList harmonics = {.count = 5, .step = 1};
  for (const auto& [name, tunnel] : cases) {
    for (const double alpha : {0.02, 0.1}) {
      const SurfaceMaterial metal(
          {.type = MaterialSettings::Type::kConductor, .reflectance = {0.7}, .alpha = {alpha}},
          path_test::kGreen_nm);
      const auto expected = summed(tunnel, metal, alpha, tilted_point(), 3.0, harmonics);
      const auto numbers = response_at(tunnel, metal, tilted_point(), 3.0, harmonics);
      double worst = 0.0;
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        worst = std::max(worst, std::abs(static_cast<double>(numbers[i]) - expected[i]));
      }
      fmt::print("{:18} alpha {:4}: even {:.4f}, first wave {:.4f}, worst {:.5f}\n",
                 name,
                 alpha,
                 expected[1],
                 std::hypot(expected[2], expected[3]),
                 worst);
      EXPECT_GT(expected[1], 0.3) << name;
      EXPECT_LT(worst, 0.002) << name << " " << alpha;
    }
  }
}

/// A wall without stripes all around returns what the metal reflects. Facets that are steeper than
/// 45 degrees send the light into the surface, which reflects it once more.
TEST(StripeResponse, OfAnEvenWallIsTheReflectance) {
  TunnelSettings wide = semicylinder();
  wide.radius_mm = 1000.0;
  wide.length_mm = 1e6;
  wide.slot_mm = 0.01;
  wide.base_mm = -1000.0;
  for (const double alpha : {0.02, 0.05, 0.1}) {
    for (const double reflectance : {1.0, 0.5}) {
      MaterialSettings settings = path_test::white_metal({alpha});
      settings.reflectance = {reflectance};
      const SurfaceMaterial metal(settings, path_test::kGreen_nm);
      const auto numbers = response_at(wide, metal, {.point_mm = {0.0, 0.0, -990.0}}, 0.0, {});
      const double steep = alpha * alpha / (1.0 + alpha * alpha);
      const double expected = reflectance * (1.0 - steep * (1.0 - reflectance));
      EXPECT_NEAR(static_cast<double>(numbers[1]), expected, 0.001) << alpha;
      EXPECT_EQ(numbers[0], 0.0F);
    }
  }
}

/// Near its middle the lobe's profile across a line is (1 + x^2 / w^2)^(-3/2) / (2 w), whose waves
/// have the height x K1(x): a plate seen from straight above, far stripes, a smooth metal.
TEST(StripeResponse, OfANarrowLobeIsABesselFunction) {
  constexpr double kAlpha = 0.005;
  TunnelSettings tunnel = semicylinder();
  tunnel.shape = TunnelSettings::Shape::kFlat;  // a roof over the point, to the left of the ridge
  tunnel.distance_mm = 400.0;
  tunnel.opening_rad = 0.98 * kPi;
  tunnel.panel_height_mm = 1000.0;
  tunnel.slot_mm = 1.0;
  tunnel.length_mm = 1e5;
  const SurfaceMaterial metal(path_test::white_metal({kAlpha}), path_test::kGreen_nm);
  const BlurredPoint point = {.point_mm = {0.0, -200.0, 0.0}};
  const auto hit = Tunnel(tunnel).hit({point.point_mm, Vector3d::UnitZ()});
  ASSERT_TRUE(hit.has_value());
  const HarmonicList harmonics = {.count = 4, .step = 1};
  tunnel.period_mm = 2.0 * kPi * 2.0 * kAlpha * hit->t_mm;  // x = 1, 2, 3, 4
  const auto numbers = response_at(tunnel, metal, point, 0.0, harmonics);
  for (int j = 0; j < harmonics.count; ++j) {
    const double x = harmonics.number(j);
    const auto at = 2 + 2 * static_cast<std::size_t>(j);
    EXPECT_NEAR(static_cast<double>(numbers[at]), x * std::cyl_bessel_k(1.0, x), 0.004) << j;
    EXPECT_NEAR(static_cast<double>(numbers[at + 1]), 0.0, 0.004) << j;
  }
}

TEST(StripeResponse, CountsAsManyHarmonicsAsTheLobeLeaves) {
  const TunnelSettings tunnel = semicylinder();
  EXPECT_EQ(harmonics_for(tunnel, 4.0).step, 2);
  EXPECT_GT(harmonics_for(tunnel, 2.0).count, harmonics_for(tunnel, 4.0).count);
  TunnelSettings bright = tunnel;
  bright.duty = 1.0;
  EXPECT_EQ(harmonics_for(bright, 4.0).count, 0);
  EXPECT_THROW(harmonics_for(tunnel, 0.01), ConfigError);
}

}  // namespace
}  // namespace glint::blurred_test
