// SPDX-License-Identifier: GPL-3.0-or-later
//
// Direct light of single points: closed forms, and sums over very many places.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/simulator/render/direct/direct_bench.h"

namespace glint::direct_test {
namespace {

Vector3d vector_at(const VectorLanes& lanes, int lane) {
  return {static_cast<double>(lanes.x[lane]),
          static_cast<double>(lanes.y[lane]),
          static_cast<double>(lanes.z[lane])};
}

/// Irradiance of a horizontal point by the places that are chosen for it.
double irradiance(const Lights& lights, const DirectPoint& point) {
  const Metal metal(path_test::white_metal({0.5}));
  const DirectLight light(lights, metal.numbers, 1, 1e-5);
  std::vector<PlaceLanes> places;
  const int count = light.choose_places(point, false, places);
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    const PlaceLanes& packet = places[static_cast<std::size_t>(i / kPacketSize)];
    const int lane = i % kPacketSize;
    const Vector3d at = vector_at(packet.point, lane);
    const double cosine = std::max(0.0, -vector_at(packet.normal, lane).dot(at));
    sum += static_cast<double>(packet.area_mm2[lane]) * cosine * std::max(0.0, at.z()) /
           std::pow(at.norm(), 4.0);
  }
  return sum;
}

// A disc of radius R at height h, c aside, gives pi / 2 (1 - (h^2 + c^2 - R^2) / root),
// root^2 = (h^2 + c^2 + R^2)^2 - 4 R^2 c^2. On its axis with R = h: pi / 2 = pi sin^2 45 degrees.
TEST(ChosenPlaces, OfADiscGiveItsFormFactor) {
  const double h = 50.0;
  for (const double radius : {5.0, 50.0, 200.0}) {
    for (const double c : {0.0, 30.0, 120.0}) {
      const double sum = h * h + c * c;
      const double root =
          std::sqrt(std::pow(sum + radius * radius, 2) - std::pow(2.0 * radius * c, 2));
      const double expected = 0.5 * kPi * (1.0 - (sum - radius * radius) / root);
      const Lights lights = lights_with({ring_above(0.0, radius, {c, 0.0, h})});
      EXPECT_NEAR(irradiance(lights, point_seen(0.3)), expected, 3e-4) << radius << " " << c;
    }
  }
}

/// Lambert's formula: half the sum over the edges of the angle an edge is seen under times the
/// height of the normal of the plane through it and the point.
double polygon_irradiance(const std::vector<Vector3d>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d a = corners[i].normalized();
    const Vector3d b = corners[(i + 1) % corners.size()].normalized();
    const Vector3d normal = a.cross(b);
    sum += std::atan2(normal.norm(), a.dot(b)) * normal.normalized().z();
  }
  return 0.5 * std::abs(sum);
}

TEST(ChosenPlaces, OfRectanglesAndTrianglesGiveLambertsFormula) {
  Rng rng(43, Stream::kTest, 0);
  for (int k = 0; k < 30; ++k) {
    const Vector3d middle(rng.uniform(-50.0, 50.0), rng.uniform(-50.0, 50.0), 80.0);
    const EmitterFrame frame =
        frame_around(middle, Vector3d(rng.uniform(-0.3, 0.3), 0.1, -1.0).normalized());
    const double x = rng.uniform(5.0, 80.0);
    const double y = rng.uniform(5.0, 60.0);
    const std::vector<Vector3d> corners = {middle + x * frame.x + y * frame.y,
                                           middle - x * frame.x + y * frame.y,
                                           middle - x * frame.x - y * frame.y,
                                           middle + x * frame.x - y * frame.y};
    const Lights rectangle =
        lights_with({RectangleShape{.frame = frame, .half_x_mm = x, .half_y_mm = y}});
    const Lights triangle =
        lights_with({TriangleShape{.a_mm = corners[0], .b_mm = corners[1], .c_mm = corners[2]}});
    const std::vector<Vector3d> half(corners.begin(), corners.begin() + 3);
    EXPECT_NEAR(irradiance(rectangle, point_seen(0.2)), polygon_irradiance(corners), 2e-4) << k;
    EXPECT_NEAR(irradiance(triangle, point_seen(0.2)), polygon_irradiance(half), 2e-4) << k;
  }
}

Lights dome() {
  return lights_with({CapShape{.radius_mm = 300.0}});
}

/// The white furnace: metal that loses nothing under a dome that shines everywhere.
TEST(DirectLight, OfADomeIsThatOfTheFurnace) {
  for (const double alpha : {0.1, 0.2, 0.5}) {
    const Metal metal(path_test::white_metal({alpha}));
    for (const double degrees : {0.0, 20.0, 45.0, 70.0}) {
      const double found = direct_at(dome(), metal.numbers, point_seen(degrees * kRadPerDeg, 0.7));
      EXPECT_NEAR(found, 1.0, 4e-3) << alpha << " " << degrees;
    }
  }
}

/// One reflection returns the directional albedo, here integrated over the facets instead.
TEST(DirectLight, OfADomeIsTheAlbedoOfOneReflection) {
  MaterialSettings plain = path_test::white_metal({0.3});
  plain.multiple_reflections = false;
  const Metal metal(plain);
  const Quadrature rule = gauss_legendre(200);
  for (const double degrees : {0.0, 30.0, 60.0, 70.0}) {
    const DirectPoint point = point_seen(degrees * kRadPerDeg);
    const double albedo = ggx_single_albedo({0.3, 0.3}, point.to_viewer, rule);
    EXPECT_LT(albedo, 0.99);
    EXPECT_NEAR(direct_at(dome(), metal.numbers, point), albedo, 2e-3) << degrees;
  }
}

/// A mirror shows the light or it does not: a lobe comes to that like its width.
TEST(DirectLight, ComesToThatOfAMirrorAsTheMetalGetsSmooth) {
  const Lights lights = lights_with({ring_above(0.0, 30.0, {0.0, 0.0, 100.0})});
  double last = 1.0;
  for (const double alpha : {0.1, 0.03, 0.01}) {
    const Metal metal(path_test::white_metal({alpha}));
    const double inside = direct_at(lights, metal.numbers, point_seen(0.1));
    const double outside = direct_at(lights, metal.numbers, point_seen(0.6));
    const double off = std::max(std::abs(inside - 1.0), std::abs(outside));
    EXPECT_LT(off, 0.5 * last) << alpha;
    last = off;
  }
  EXPECT_LT(last, 0.02);
}

/// Under a ring on the axis nothing changes when the viewer walks around it.
TEST(DirectLight, UnderARingIsTheSameFromAllSides) {
  const Metal metal(path_test::white_metal({0.2}));
  const Lights lights = lights_with({ring_above(30.0, 50.0, {0.0, 0.0, 100.0})});
  const double expected = direct_at(lights, metal.numbers, point_seen(0.35));
  EXPECT_GT(expected, 0.1);
  for (int k = 1; k < 12; ++k) {
    EXPECT_NEAR(direct_at(lights, metal.numbers, point_seen(0.35, 0.5 * k)), expected, 2e-3);
  }
}

TEST(DirectLight, OfARingIsThatOfItsSectors) {
  const Metal metal(path_test::white_metal({0.15}));
  const RingShape ring = ring_above(30.0, 50.0, {10.0, 0.0, 100.0});
  Lights sectors;
  for (int k = 0; k < 5; ++k) {
    RingShape sector = ring;
    sector.first_rad = 0.4 * kPi * k;
    sector.span_rad = 0.4 * kPi;
    sectors.groups.push_back({.name = "sector"});
    sectors.emitters.push_back({.shape = sector, .group = k});
  }
  const DirectLight light(sectors, metal.numbers, 1, kTolerance);
  DirectLight::Scratch scratch;
  std::vector<float> radiance(light.size());
  light.at(point_seen(0.4), {}, scratch, radiance);
  double sum = 0.0;
  for (const float of_sector : radiance) {
    sum += static_cast<double>(of_sector);
  }
  EXPECT_GT(static_cast<double>(*std::ranges::max_element(radiance)), 0.4 * sum);
  EXPECT_NEAR(direct_at(lights_with({ring}), metal.numbers, point_seen(0.4)), sum, 2e-3);
}

EmitterShape random_shape(Rng& rng, int kind) {
  const Vector3d at(rng.uniform(-60.0, 60.0), rng.uniform(-60.0, 60.0), rng.uniform(40.0, 200.0));
  const Vector3d down = Vector3d(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), -1.0).normalized();
  if (kind == 0) {
    return RectangleShape{.frame = frame_around(at, down),
                          .half_x_mm = rng.uniform(5.0, 100.0),
                          .half_y_mm = rng.uniform(3.0, 30.0)};
  }
  if (kind == 1) {
    const double r = rng.uniform(30.0, 100.0);
    return CapShape{.frame = frame_around(Vector3d::Zero(), Vector3d::UnitZ()),
                    .radius_mm = r,
                    .top_rad = rng.uniform(0.0, 0.4),
                    .rim_rad = rng.uniform(0.8, 1.7)};
  }
  const double inner = rng.uniform(0.0, 60.0);
  RingShape ring = ring_above(inner, inner + rng.uniform(5.0, 60.0), at);
  ring.tilt_rad = kind == 2 ? 0.0 : rng.uniform(0.0, 0.6);
  ring.width_mm = std::min(ring.width_mm, 2.0 * ring.middle_radius_mm);
  ring.span_rad = rng.uniform(1.0, 2.0 * kPi);
  return ring;
}

/// Distances from the sums over n x n places: root of the mean square, and largest.
struct Distance {
  double rms = 0.0;
  double largest = 0.0;
  double places = 0.0;
};

Distance distance_from_many(const MaterialSettings& settings, double exponent, int cases, int n) {
  const Metal metal(settings);
  Rng rng(41, Stream::kTest, static_cast<std::uint64_t>(100.0 * settings.alpha[0]));
  Distance distance;
  DirectLight::Scratch scratch;
  for (int k = 0; k < cases; ++k) {
    const Lights lights = lights_with({random_shape(rng, k % 4)}, exponent);
    const DirectPoint point = point_seen(rng.uniform(0.0, 1.22), rng.uniform(0.0, 6.0));
    std::vector<float> found(1);
    const DirectLight light(lights, metal.numbers, 1, kTolerance);
    distance.places += static_cast<double>(light.at(point, {}, scratch, found)) / cases;
    const double expected = summed_by_area(lights, metal.material.plain(), point, n);
    const double off = static_cast<double>(found[0]) - expected;
    distance.rms += off * off / cases;
    distance.largest = std::max(distance.largest, std::abs(off));
  }
  distance.rms = std::sqrt(distance.rms);
  fmt::print(
      "alpha {:4} {:4}, lobe cos^{}: {:.5f} from many places, {:.5f} at most, {:.0f} places\n",
      settings.alpha.front(),
      settings.alpha.back(),
      exponent,
      distance.rms,
      distance.largest,
      distance.places);
  return distance;
}

TEST(DirectLight, IsThatOfManyPlaces) {
  for (const double alpha : {0.1, 0.2, 0.3, 0.5}) {
    const Distance distance = distance_from_many(path_test::white_metal({alpha}), 1.0, 60, 300);
    EXPECT_LT(distance.rms, 1e-3) << alpha;
    EXPECT_LT(distance.largest, 5e-3) << alpha;
  }
}

TEST(DirectLight, OfBrushedMetalColourAndLobesIsThatOfManyPlaces) {
  MaterialSettings brushed = path_test::white_metal({0.1, 0.3});
  brushed.reflectance = {0.6};
  brushed.schlick = true;
  for (const double exponent : {1.0, 4.0}) {
    const Distance distance = distance_from_many(brushed, exponent, 40, 300);
    EXPECT_LT(distance.rms, 1e-3) << exponent;
    EXPECT_LT(distance.largest, 5e-3) << exponent;
  }
}

/// The control: a tolerance a hundred times wider is seen.
TEST(DirectLight, OfAWideToleranceIsNotThatOfManyPlaces) {
  const Metal metal(path_test::white_metal({0.1}));
  const Lights lights = lights_with({ring_above(20.0, 60.0, {20.0, 10.0, 60.0})});
  const DirectPoint point = point_seen(0.3, 1.0);
  const double expected = summed_by_area(lights, metal.material.plain(), point, 400);
  EXPECT_NEAR(direct_at(lights, metal.numbers, point), expected, 1e-3);
  EXPECT_GT(std::abs(direct_at(lights, metal.numbers, point, 0.5) - expected), 3e-3);
}

TEST(DirectLight, IsBlackFromBehindAndFromLightsBelow) {
  const Metal metal(path_test::white_metal({0.3}));
  const Lights above = lights_with({ring_above(0.0, 40.0, {0.0, 0.0, 60.0})});
  RingShape below = ring_above(0.0, 40.0, {0.0, 0.0, -60.0});
  below.frame = frame_around({0.0, 0.0, -60.0}, Vector3d::UnitZ());
  EXPECT_GT(direct_at(above, metal.numbers, point_seen(0.3)), 0.1);
  EXPECT_EQ(direct_at(above, metal.numbers, point_seen(2.0)), 0.0);
  EXPECT_EQ(direct_at(lights_with({below}), metal.numbers, point_seen(0.3)), 0.0);
}

TEST(DirectLight, RefusesWhatIsNoSurface) {
  const Metal metal(path_test::white_metal({0.3}));
  Lights sky = path_test::lights_of({path_test::white_sky()}, {});
  EXPECT_FALSE(lights_without_direct_sum(sky).empty());
  EXPECT_THROW(DirectLight(sky, metal.numbers, 1, kTolerance), ConfigError);
  EXPECT_TRUE(lights_without_direct_sum(dome()).empty());
}

}  // namespace
}  // namespace glint::direct_test
