// SPDX-License-Identifier: GPL-3.0-or-later
//
// Blurred reflections against path tracing under ten random tunnels of all shapes, at three widths
// of the metal, each at the bar by itself. Prints the error of each. GLINT_TUNNELS=0,8 chooses
// tunnels, GLINT_SAMPLES=2048 the samples of each of the two path-traced pictures.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/cpu_clock.h"
#include "core/rng.h"
#include "tests/simulator/render/blurred/blurred_bench.h"

namespace glint::blurred_test {
namespace {

constexpr double kRms = 0.002;  // of full scale, as the percentile: the reference's noise taken out
constexpr double kPercentile = 0.01;

TunnelSettings random_tunnel(Rng& rng, std::uint64_t index) {
  TunnelSettings t;
  t.shape = static_cast<TunnelSettings::Shape>(index % 5);
  t.base_mm = rng.uniform(-15.0, 0.0);
  t.radius_mm = rng.uniform(70.0, 150.0);
  t.half_width_mm = rng.uniform(70.0, 140.0);
  t.height_mm = rng.uniform(80.0, 180.0);
  t.exponent = rng.uniform(1.5, 4.0);
  t.distance_mm = rng.uniform(60.0, 100.0);
  t.opening_rad = rng.uniform(0.5, 1.2);
  t.panel_height_mm = rng.uniform(150.0, 250.0);
  for (double& control : t.control_mm) {
    control = rng.uniform(80.0, 140.0);
  }
  t.length_mm = rng.uniform(300.0, 800.0);
  t.slot_mm = rng.uniform(14.0, 24.0);
  t.period_mm = rng.uniform(12.0, 40.0);
  t.duty = index % 2 == 0 ? 0.5 : rng.uniform(0.3, 0.7);
  t.orientation_rad = index % 3 == 1 ? rng.uniform(-1.5, 1.5) : 0.0;
  t.offset_mm = rng.uniform(0.0, 10.0);
  t.dark_reflectance = index % 4 == 3 ? rng.uniform(0.2, 0.8) : 0.0;
  t.cosine_law = index % 4 == 2;
  return t;
}

/// A flat plate, or a strip that is bent both ways, a little or like a rod.
PartSettings random_part(Rng& rng, std::uint64_t index) {
  if (index % 3 == 0) {
    return {.shape = PartSettings::Shape::kPlate,
            .length_mm = 60.0,
            .width_mm = 30.0,
            .thickness_mm = 2.0};
  }
  return {.shape = PartSettings::Shape::kStrip,
          .length_mm = 60.0,
          .width_mm = 24.0,
          .radius_along_mm = rng.uniform(300.0, 900.0),
          .radius_across_mm = index % 3 == 1 ? rng.uniform(60.0, 200.0) : rng.uniform(14.0, 30.0),
          .thickness_mm = 3.0};
}

BlurredScene random_scene(std::uint64_t index, double alpha) {
  Rng rng(31, Stream::kTest, index);
  BlurredScene scene = {.part = random_part(rng, index), .tunnel = random_tunnel(rng, index)};
  scene.metal = path_test::white_metal({alpha, alpha});
  if (index % 2 == 1) {
    scene.metal.schlick = true;
    scene.metal.reflectance = {rng.uniform(0.4, 0.95)};
  }
  scene.camera = {
      .width_px = 40, .height_px = 24, .object_pixel_mm = 1.2, .working_distance_mm = 400.0};
  scene.viewpoint = {.position_mm = {rng.uniform(-20.0, 20.0), rng.uniform(-4.0, 4.0), 400.0}};
  scene.scan.positions = 6 + static_cast<int>(index % 4);
  // Neighbouring rays part by half of the lobe's width, 2 alpha, at most.
  const double turn_rad = scene.part.shape == PartSettings::Shape::kStrip
                              ? 2.0 * scene.camera.object_pixel_mm / scene.part.radius_across_mm
                              : 0.0;
  scene.rays_per_axis = std::clamp(static_cast<int>(std::ceil(turn_rad / alpha)), 2, 16);
  return scene;
}

int samples() {
  const char* wanted = std::getenv("GLINT_SAMPLES");
  return wanted != nullptr ? std::atoi(wanted) : 8192;
}

bool is_wanted(std::uint64_t index) {
  const char* wanted = std::getenv("GLINT_TUNNELS");
  return wanted == nullptr ||
         fmt::format(",{},", wanted).find(fmt::format(",{},", index)) != std::string::npos;
}

TEST(BlurredReflections, AreThoseOfPathTracingUnderRandomTunnels) {
  for (const double alpha : {0.02, 0.05, 0.1}) {
    for (std::uint64_t index = 0; index < 10; ++index) {
      if (!is_wanted(index)) {
        continue;
      }
      const BlurredScene scene = random_scene(index, alpha);
      const PathBench bench = bench_of(scene);
      ASSERT_TRUE(bench.bvh.is_convex()) << index;
      const Mask where = inner_pixels(scene, bench);
      const double before_s = thread_cpu_s();
      const BlurredPixels pixels = blurred_of(scene, bench);
      const double took_s = thread_cpu_s() - before_s;
      const auto frames = frames_of(scene, pixels);
      const double paths_before_s = process_cpu_s();
      const auto first = traced_frames(scene, bench, samples(), 1);
      const auto second = traced_frames(scene, bench, samples(), 1000);
      const double paths_s = process_cpu_s() - paths_before_s;
      const BlurredError error = error_of(frames, first, second, where);
      // What paths of the same error would cost: noise falls with the root of the samples. Errors
      // below 0.0005 are not told apart from none.
      const double least = std::max(error.rms, 5e-4);
      const double same_error_s = paths_s * error.noise * error.noise / (least * least);
      fmt::print(
          "alpha {:4} {} {:12} rms {:.5f} 99 % {:.5f} mean {:+.5f} (noise {:.5f}, contrast {:.3f}, "
          "{} values), {} rays a pixel, {} harmonics, {} points, {:.0f} ms, paths of the same "
          "error {:.0f} times as much\n",
          alpha,
          index,
          shape_name(scene.tunnel.shape),
          error.rms,
          error.percentile,
          error.mean,
          error.noise,
          error.contrast,
          error.values,
          scene.rays_per_axis * scene.rays_per_axis,
          pixels.harmonics.count,
          pixels.points,
          1e3 * took_s,
          same_error_s / took_s);
      EXPECT_GT(error.values, 300U) << index;
      EXPECT_LT(error.rms, kRms) << index;
      EXPECT_LT(error.percentile, kPercentile) << index;
    }
  }
}

/// Distance in the cross-section's plane from a point to the wall.
double to_wall_mm(const Tunnel& tunnel, const Eigen::Vector3d& point_mm, double phi_rad) {
  const auto hit = tunnel.hit({point_mm, {0.0, std::sin(phi_rad), std::cos(phi_rad)}});
  return hit ? hit->t_mm : 0.0;
}

/// How far the frames of a point are from those of its stripes blurred by x K1(x), with the right
/// mean: rms over all positions, squared. Empty where the mirrored ray meets the slot.
std::optional<double> off_by_formula(const Tunnel& tunnel,
                                     const ConductorNumbers& metal,
                                     const BlurredPoint& point) {
  constexpr double kStep_rad = 1e-3;
  const HarmonicList harmonics = {.count = 8, .step = 2};
  const LobeShape shape = lobe_shape(point, static_cast<double>(metal.alpha_x));
  const double distance_mm = to_wall_mm(tunnel, point.point_mm, shape.phi0_rad);
  const double ahead_mm = to_wall_mm(tunnel, point.point_mm, shape.phi0_rad + kStep_rad);
  if (distance_mm == 0.0 || ahead_mm == 0.0) {
    return std::nullopt;
  }
  const double width_mm =
      shape.width_along(shape.t0 * (ahead_mm - distance_mm) / kStep_rad, distance_mm);
  const StripeResponse response(tunnel, metal, 0.0, harmonics);
  std::vector<float> numbers(response.size());
  response.at(point, point.point_mm.x() + shape.t0 * distance_mm, numbers);
  double squares = 0.0;
  for (int j = 0; j < harmonics.count; ++j) {
    const int m = harmonics.number(j);
    const double x = 2.0 * kPi * m * width_mm / tunnel.settings().period_mm;
    const auto at = 2 + 2 * static_cast<std::size_t>(j);
    const double real = static_cast<double>(numbers[at]) -
                        static_cast<double>(numbers[1]) * x * std::cyl_bessel_k(1.0, x);
    const double amplitude = 2.0 / (kPi * m);
    squares += 0.5 * amplitude * amplitude *
               (real * real + std::pow(static_cast<double>(numbers[at + 1]), 2));
  }
  return squares;
}

/// Why directions are summed: the lobe's own formula alone is off by more than the bar.
TEST(BlurredReflections, AreMoreThanTheLobesFormula) {
  const Tunnel tunnel({.radius_mm = 100.0, .slot_mm = 16.0, .period_mm = 24.0});
  for (const double alpha : {0.02, 0.05, 0.1}) {
    const SurfaceMaterial material(path_test::white_metal({alpha}), path_test::kGreen_nm);
    const auto metal = conductor_numbers(material.plain());
    for (const bool is_bent : {false, true}) {
      Rng rng(32, Stream::kTest, 0);
      double squares = 0.0;
      int count = 0;
      while (count < 200) {
        const Eigen::Vector3d point_mm(rng.uniform(-20.0, 20.0), rng.uniform(-9.0, 9.0), 2.0);
        Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
        if (is_bent) {
          normal += Eigen::Vector3d(rng.uniform(-0.1, 0.1), rng.uniform(-0.5, 0.5), 0.0);
          normal.normalize();
        }
        const Eigen::Vector3d to_viewer =
            (Eigen::Vector3d(0.0, 0.0, 300.0) - point_mm).normalized();
        const auto off =
            off_by_formula(tunnel,
                           metal.value(),
                           {.point_mm = point_mm,
                            .to_viewer = to_viewer,
                            .mirrored = 2.0 * normal.dot(to_viewer) * normal - to_viewer});
        squares += off.value_or(0.0);
        count += off ? 1 : 0;
      }
      const double rms = std::sqrt(squares / count);
      fmt::print(
          "alpha {:4}, {:5}: x K1(x) is off by {:.4f}\n", alpha, is_bent ? "bent" : "plate", rms);
      EXPECT_GT(rms, alpha < 0.1 ? kRms : 0.0);
    }
  }
}

}  // namespace
}  // namespace glint::blurred_test
