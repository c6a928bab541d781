// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of rough metal by blurred reflections.
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/blurred/blurred_scan.h"
#include "tests/simulator/render/blurred/blurred_bench.h"

namespace glint::blurred_test {
namespace {

/// A strip that is bent both ways under a semicylinder; the slot is mirrored in it.
BlurredScene strip_scene(double alpha) {
  BlurredScene scene;
  scene.part = {.shape = PartSettings::Shape::kStrip,
                .length_mm = 46.0,
                .width_mm = 18.0,
                .radius_along_mm = 400.0,
                .radius_across_mm = 40.0,
                .thickness_mm = 3.0};
  scene.metal = path_test::white_metal({alpha});
  scene.camera = {
      .width_px = 30, .height_px = 16, .object_pixel_mm = 1.5, .working_distance_mm = 300.0};
  scene.viewpoint = default_viewpoint(scene.camera);
  scene.tunnel = {.shape = TunnelSettings::Shape::kSemicylinder,
                  .radius_mm = 100.0,
                  .length_mm = 600.0,
                  .slot_mm = 16.0,
                  .period_mm = 24.0};
  scene.scan.positions = 6;
  return scene;
}

TEST(BlurredFrames, AreThoseOfPathTracing) {
  BlurredScene scene = strip_scene(0.03);
  scene.rays_per_axis = 3;  // 25 mrad from ray to ray, less than half of the lobe's width
  const PathBench bench = bench_of(scene);
  const auto a = traced_frames(scene, bench, 1024, 1);
  const auto b = traced_frames(scene, bench, 1024, 2000);
  const Mask where = inner_pixels(scene, bench);
  const BlurredError error = error_of(frames_of(scene, blurred_of(scene, bench)), a, b, where);
  // A lobe that is a fifth wider.
  BlurredScene wide = scene;
  wide.metal = path_test::white_metal({0.036});
  const BlurredError control =
      error_of(frames_of(wide, blurred_of(wide, bench_of(wide))), a, b, where);
  fmt::print("rms {:.4f}, control {:.4f}, noise {:.4f}\n", error.rms, control.rms, error.noise);
  EXPECT_GT(error.values, 600U);
  EXPECT_GT(error.contrast, 0.1);
  EXPECT_LT(error.rms, 0.002);
  EXPECT_GT(control.rms, 0.01);
}

/// What is judged, which is right but for `off`, against two noisy pictures: each by 0.0057, their
/// mean by 0.004, whose 99th percentile is 0.0103.
BlurredError error_under_noise(const ImageF& off) {
  Rng rng(41, Stream::kTest, 0);
  std::vector<std::vector<ImageF>> noisy(2, {ImageF(off.width(), off.height())});
  for (auto& frames : noisy) {
    for (float& value : frames.front().values()) {
      value = static_cast<float>(0.004 * std::sqrt(2.0) * rng.normal());
    }
  }
  return error_of({off}, noisy[0], noisy[1], Mask(off.width(), off.height(), 1));
}

// Of errors of 0.003 the 99th percentile is 2.576 times as much; with the noise it were 0.0129.
TEST(BlurredErrorOf, TakesTheNoiseOfTheReferenceOutOfBothFigures) {
  ImageF off(200, 200);
  Rng rng(42, Stream::kTest, 0);
  for (float& value : off.values()) {
    value = static_cast<float>(0.003 * rng.normal());
  }
  const BlurredError error = error_under_noise(off);
  EXPECT_NEAR(error.noise, 0.004, 1e-4);
  EXPECT_NEAR(error.rms, 0.003, 3e-4);
  EXPECT_NEAR(error.percentile, 0.0077, 6e-4);
}

// 0.02 in each 50th pixel.
TEST(BlurredErrorOf, FindsFewPixelsThatAreFarOffUnderNoise) {
  ImageF off(200, 200);
  for (std::size_t i = 0; i < off.size(); i += 50) {
    off.values()[i] = 0.02F;
  }
  EXPECT_GT(error_under_noise(off).percentile, 0.015);
}

/// The difference from a mirror falls with the width.
TEST(BlurredFrames, ComeToThoseOfAMirrorAsTheMetalGetsSmooth) {
  double last = 1.0;
  for (const double alpha : {0.1, 0.02, 0.006}) {
    const BlurredScene scene = strip_scene(alpha);
    const PathBench bench = bench_of(scene);
    const RayCache rays = rays_of(scene, bench);
    const Tunnel tunnel(scene.tunnel);
    const Eigen::Vector3d camera_mm = inverse(bench.pose).translation_mm;
    const WallRays wall = intersect_wall(rays, tunnel, camera_mm);
    const auto frames = frames_of(scene, blurred_of(scene, bench));
    std::vector<ImageF> mirror(frames.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const double shift_mm = static_cast<double>(k) * scan_step_mm(scene.scan, scene.tunnel);
      render_frame(rays, wall, tunnel.pattern(shift_mm), mirror[k]);
    }
    const double rms = error_of(frames, mirror, mirror, inner_pixels(scene, bench)).rms;
    fmt::print("alpha {}: {:.4f} from a mirror\n", alpha, rms);
    EXPECT_LT(rms, 0.7 * last);
    last = rms;
  }
  EXPECT_LT(last, 0.15);
}

/// Interpolation changes a picture by less than its bound.
TEST(BlurredFrames, AreInterpolatedWithinTheBound) {
  BlurredScene scene = strip_scene(0.05);
  scene.camera.width_px = 200;
  scene.camera.height_px = 80;
  scene.camera.object_pixel_mm = 0.2;
  scene.viewpoint = default_viewpoint(scene.camera);
  scene.rays_per_axis = 1;
  const PathBench bench = bench_of(scene);
  const RayCache rays = rays_of(scene, bench);
  const Eigen::Vector3d camera_mm = inverse(bench.pose).translation_mm;
  const BlurredPixels pixels = blurred_of(scene, bench);
  const auto metal = conductor_numbers(bench.material.plain());
  const Tunnel tunnel(scene.tunnel);
  const double middle_x_mm =
      0.5 * (scene.scan.positions - 1) * scan_step_mm(scene.scan, scene.tunnel);
  const StripeResponse response(tunnel, metal.value(), middle_x_mm, pixels.harmonics);
  const auto factors = wave_factors(pixels.harmonics, scene.tunnel, 0.0);
  const std::vector<ImageF> frames = frames_of(scene, pixels);
  std::vector<float> numbers(response.size());
  double worst = 0.0;
  for (std::size_t i = 3; i < rays.weight.size(); i += 97) {
    if (rays.weight[i] == 0.0F) {
      continue;
    }
    const Eigen::Vector3d point_mm(static_cast<double>(rays.origin_x[i]),
                                   static_cast<double>(rays.origin_y[i]),
                                   static_cast<double>(rays.origin_z[i]));
    const Eigen::Vector3d mirrored(static_cast<double>(rays.direction_x[i]),
                                   static_cast<double>(rays.direction_y[i]),
                                   static_cast<double>(rays.direction_z[i]));
    response.at({.point_mm = point_mm,
                 .to_viewer = (camera_mm - point_mm).normalized(),
                 .mirrored = mirrored},
                0.0,
                numbers);
    float expected = numbers[0] + 0.5F * numbers[1];
    for (std::size_t j = 0; j < factors.size(); ++j) {
      expected += (factors[j] * std::complex<float>(numbers[2 + 2 * j], numbers[3 + 2 * j])).real();
    }
    worst = std::max(worst, std::abs(static_cast<double>(expected - frames[0].values()[i])));
  }
  const auto lit = static_cast<double>(rays.counts.part);
  fmt::print("worst {:.5f}, {} points for {} pixels\n", worst, pixels.points, rays.counts.part);
  EXPECT_LT(worst, 0.0015);
  EXPECT_LT(static_cast<double>(pixels.points), 0.5 * lit);
}

/// The mean of a scan over whole periods is that of an even wall as bright as the duty.
TEST(BlurredFrames, HaveTheMeanOfAnEvenWall) {
  BlurredScene scene = strip_scene(0.05);
  scene.tunnel.duty = 0.5;
  const PathBench bench = bench_of(scene);
  const Sensor sensor({.blur_px = 0.0, .bits = 0}, scene.camera.width_px, scene.camera.height_px);
  const auto metal = conductor_numbers(bench.material.plain());
  const Eigen::Vector3d camera_mm = inverse(bench.pose).translation_mm;
  const RayCache rays = rays_of(scene, bench);
  const BlurredPixels pixels =
      blurred_pixels(rays, Tunnel(scene.tunnel), *metal, scene.scan, camera_mm);
  const ImageF mean = take_blurred_scan(pixels, scene.tunnel, sensor, scene.scan).aspect;
  BlurredScene even = scene;
  even.tunnel.duty = 1.0;
  const BlurredPixels bright = blurred_of(even, bench);
  double brightest = 0.0;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const double expected = 0.5 * static_cast<double>(bright.even.values()[i]);
    EXPECT_NEAR(static_cast<double>(mean.values()[i]), expected, 1e-3);
    brightest = std::max(brightest, expected);
  }
  EXPECT_GT(brightest, 0.4);
}

}  // namespace
}  // namespace glint::blurred_test
