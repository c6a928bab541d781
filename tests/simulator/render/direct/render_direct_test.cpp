// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures in direct light against path tracing.
#include <array>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/simulator/render/direct/picture_bench.h"

namespace glint::direct_test {
namespace {

PartSettings bent_strip() {
  return {.shape = PartSettings::Shape::kStrip,
          .length_mm = 40.0,
          .width_mm = 24.0,
          .radius_along_mm = 300.0,
          .radius_across_mm = 40.0,
          .thickness_mm = 3.0};
}

NamedLight ring_of(double inner_mm, double outer_mm, double height_mm) {
  RingSettings ring;
  ring.placement.position_mm = {0.0, 0.0, height_mm};
  ring.inner_radius_mm = inner_mm;
  ring.outer_radius_mm = outer_mm;
  return {.name = "ring", .settings = ring};
}

/// Below the lights, which would hide the part from further away.
constexpr double kNear_mm = 60.0;

CameraSettings camera_of(int width, int height, double pixel_mm, double distance_mm = kNear_mm) {
  return {.width_px = width,
          .height_px = height,
          .object_pixel_mm = pixel_mm,
          .working_distance_mm = distance_mm};
}

PathBench strip_bench(const std::vector<NamedLight>& lights, double alpha) {
  return PathBench(build_part(bent_strip()),
                   path_test::white_metal({alpha}),
                   lights,
                   camera_of(32, 20, 1.0),
                   view_from(0.4, 0.5, kNear_mm));
}

TEST(DirectPicture, IsThatOfPathTracing) {
  const PathBench bench = strip_bench({ring_of(30.0, 60.0, 110.0)}, 0.2);
  const ImageF a = traced_picture(bench, 512, 1);
  const ImageF b = traced_picture(bench, 512, 900);
  const PictureError error = error_of(direct_picture(bench), a, b);
  // The control: a ring that is a tenth larger.
  const PathBench wide = strip_bench({ring_of(33.0, 66.0, 110.0)}, 0.2);
  const PictureError control = error_of(direct_picture(wide), a, b);
  fmt::print("rms {:.5f}, control {:.5f}, noise {:.5f}, mean {:+.5f}\n",
             error.rms,
             control.rms,
             error.noise,
             error.mean);
  EXPECT_GT(error.full_scale, 0.2);
  EXPECT_LT(error.rms, 0.006);
  EXPECT_LT(std::abs(error.mean), 0.003);
  EXPECT_GT(control.rms, 0.01);
}

/// A bar stands between the part and a larger one.
TEST(DirectPicture, KnowsLightsThatStandBeforeOthers) {
  BarSettings far;
  far.placement.position_mm = {0.0, 0.0, 150.0};
  far.length_mm = 120.0;
  far.width_mm = 80.0;
  BarSettings near;
  near.placement.position_mm = {10.0, 0.0, 70.0};
  near.length_mm = 30.0;
  near.width_mm = 30.0;
  near.emission.radiance = {0.2};
  const PathBench bench = strip_bench({{"far", far}, {"near", near}}, 0.3);
  const ImageF a = traced_picture(bench, 256, 1);
  const ImageF b = traced_picture(bench, 256, 900);
  const PictureError error = error_of(direct_picture(bench), a, b);
  const PathBench alone = strip_bench({{"far", far}}, 0.3);
  const PictureError control = error_of(direct_picture(alone), a, b);
  fmt::print("rms {:.5f}, control {:.5f}\n", error.rms, control.rms);
  EXPECT_LT(error.rms, 0.02);
  EXPECT_GT(control.rms, 0.05);
}

/// A gear's teeth shade each other.
TEST(DirectPicture, KnowsWhatThePartHidesFromItself) {
  PartSettings gear;
  gear.shape = PartSettings::Shape::kSpurGear;
  const PathBench bench(build_part(gear),
                        path_test::white_metal({0.3}),
                        {ring_of(60.0, 90.0, 60.0)},
                        camera_of(32, 32, 1.5, 300.0),
                        view_from(0.7, 0.3, 300.0));
  ASSERT_FALSE(bench.bvh.is_convex());
  const PictureError error = error_of(
      direct_picture(bench), traced_picture(bench, 256, 1), traced_picture(bench, 256, 900));
  fmt::print("rms {:.5f}, 95 % {:.5f}, noise {:.5f}, full scale {:.3f}\n",
             error.rms,
             error.percentile,
             error.noise,
             error.full_scale);
  EXPECT_LT(error.rms, 0.02 * error.full_scale);
  EXPECT_LT(std::abs(error.mean), 0.01);
}

/// Masks and surface pictures are those of path tracing with as many samples.
TEST(DirectPicture, HasTheMasksOfPathTracing) {
  const PathBench bench = strip_bench({ring_of(30.0, 60.0, 110.0)}, 0.2);
  const Film direct = direct_film(bench);
  const Film traced = bench.render(path_settings(4));
  EXPECT_EQ(direct.part.values(), traced.part.values());
  EXPECT_EQ(direct.samples.values(), traced.samples.values());
  EXPECT_EQ(direct.normal_x.values(), traced.normal_x.values());
  EXPECT_EQ(direct.groups.size(), traced.groups.size());
  const ImageF error = standard_error_image(direct, group_factors(bench.lights));
  EXPECT_LT(*std::ranges::max_element(error.values()), 1e-3F);
}

TEST(DirectPicture, IsTheSameForAnyNumberOfThreads) {
  const PathBench bench = strip_bench({ring_of(30.0, 60.0, 110.0)}, 0.15);
  const Film one = direct_film(bench);
  for (const int threads : {2, 7}) {
    const Film many = direct_film(bench, {}, threads);
    EXPECT_EQ(one.groups[0].channels[0].values(), many.groups[0].channels[0].values());
    EXPECT_EQ(one.squares.values(), many.squares.values());
  }
}

/// Interpolation changes a picture by about what it may, and saves most points.
TEST(DirectPicture, IsInterpolatedWithinTheBound) {
  const PathBench bench(build_part(bent_strip()),
                        path_test::white_metal({0.2}),
                        {ring_of(30.0, 60.0, 110.0)},
                        camera_of(160, 96, 0.2),
                        view_from(0.3, 0.5, kNear_mm));
  DirectCounts all, few;
  const ImageF summed = direct_picture(bench, {.interpolated = 0.0}, &all);
  const ImageF quick = direct_picture(bench, {}, &few);
  double worst = 0.0;
  for (std::size_t i = 0; i < summed.size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>(summed.values()[i] - quick.values()[i])));
  }
  fmt::print("worst {:.5f}, {} points of {}\n", worst, few.points, all.points);
  EXPECT_LT(worst, 0.003);
  EXPECT_LT(3 * few.points, all.points);
}

TEST(DirectPicture, RefusesWhatItCannotSum) {
  PathBench bench = strip_bench({ring_of(30.0, 60.0, 110.0)}, 0.2);
  EXPECT_TRUE(scene_without_direct_sum(bench.scene()).empty());
  bench.lens = {.aperture_mm = 5.0, .focus_mm = 300.0};
  EXPECT_THROW(direct_film(bench), ConfigError);
  const PathBench sky = strip_bench({path_test::white_sky()}, 0.2);
  EXPECT_THROW(direct_film(sky), ConfigError);
  const PathBench matt(bent_strip(), path_test::matt(0.5), {}, path_test::small_camera());
  EXPECT_THROW(direct_film(matt), ConfigError);
  const PathBench good = strip_bench({ring_of(30.0, 60.0, 110.0)}, 0.2);
  EXPECT_THROW(direct_film(good, {.tolerance = 0.0}), ConfigError);
  EXPECT_THROW(direct_film(good, {.rays_per_axis = 0}), ConfigError);
}

}  // namespace
}  // namespace glint::direct_test
