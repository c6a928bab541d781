// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "simulator/render/path_tracing/path_settings.h"
#include "tests/simulator/render/path_tracing/path_bench.h"

namespace glint::path_test {
namespace {

MaterialSettings rough_steel() {
  return {.type = MaterialSettings::Type::kConductor, .reflectance = {0.6}, .alpha = {0.2, 0.1}};
}

PathBench steel_gear() {
  PartSettings gear = {.shape = PartSettings::Shape::kSpurGear};
  gear.rotation_rad = {0.3, 1.2, 0.0};
  return {gear, rough_steel(), {ring_at(150.0), bar_aside()}, small_camera(3.0, 24, 22)};
}

bool is_same(const Film& a, const Film& b) {
  bool same = a.samples == b.samples && a.squares == b.squares && a.part == b.part &&
              a.depth_mm == b.depth_mm && a.normal_x == b.normal_x && a.x_mm == b.x_mm &&
              a.tilt == b.tilt && a.triangle == b.triangle && a.defect == b.defect &&
              a.counts.shadow == b.counts.shadow;
  for (std::size_t g = 0; g < a.groups.size(); ++g) {
    same = same && a.groups[g].channels == b.groups[g].channels;
  }
  return same;
}

TEST(RenderPaths, GivesTheSameBytesForAnyNumberOfThreads) {
  const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 7);
  const PathBench bench = steel_gear();
  const PathSettings settings = {.samples = 32, .relative_error = 0.1};
  const Film one = bench.render(settings, 1);
  EXPECT_TRUE(is_same(one, bench.render(settings, 2)));
  EXPECT_TRUE(is_same(one, bench.render(settings, 7)));
  PathSettings other = settings;
  other.seed = 2;
  EXPECT_FALSE(is_same(one, bench.render(other, 1)));  // the comparison can tell
}

TEST(RenderPaths, ErrorFallsAtLeastWithTheRootOfTheSamples) {
  const PathBench bench = steel_gear();
  const ImageF reference = bench.picture({.samples = 2048, .seed = 99});
  const auto error_at = [&](int samples) {
    double sum = 0.0;
    for (int seed = 1; seed <= 3; ++seed) {
      sum += rms_difference(bench.picture({.samples = samples, .seed = seed}), reference);
    }
    return sum / 3.0;
  };
  const double coarse = error_at(4);
  const double fine = error_at(64);
  EXPECT_GT(fine, 0.0);
  EXPECT_LT(fine, 1.05 * coarse / 4.0);  // 16 times the samples; 5 % for the estimate itself
}

TEST(RenderPaths, StatedErrorCoversTheTrueOne) {
  const PathBench bench = steel_gear();
  const ImageF reference = bench.picture({.samples = 2048, .seed = 99});
  const Film sums = bench.render({.samples = 64});
  const std::vector<double> factors = group_factors(bench.lights);
  const ImageF stated = standard_error_image(sums, factors);
  const double true_error = rms_difference(total_image(sums, factors, 0), reference);
  const double stated_error = rms_difference(stated, ImageF(stated.width(), stated.height()));
  EXPECT_LT(true_error, 1.1 * stated_error);
  EXPECT_GT(true_error, 0.1 * stated_error);
}

TEST(RenderPaths, StopsWhereTheErrorIsSmallEnough) {
  const PathBench bench = steel_gear();
  const PathSettings full = {.samples = 512};
  PathSettings adaptive = full;
  adaptive.relative_error = 0.2;
  const Film sums = bench.render(adaptive);
  std::int64_t samples = 0;
  for (const std::int32_t of_pixel : sums.samples.values()) {
    samples += of_pixel;
  }
  EXPECT_LT(samples, static_cast<std::int64_t>(sums.samples.size()) * full.samples * 3 / 4);
  EXPECT_GE(samples, static_cast<std::int64_t>(sums.samples.size()) * adaptive.min_samples);
  const double mean = mean_of(bench.picture(full));
  EXPECT_NEAR(mean_of(total_image(sums, group_factors(bench.lights), 0)), mean, 0.03 * mean);
}

TEST(RenderPaths, ShowsPassesAndStopsWhenAsked) {
  const PathBench bench = steel_gear();
  std::vector<int> samples;
  ThreadPool pool(2);
  const auto preview = [&](const PathProgress& progress) {
    EXPECT_EQ(progress.sums->samples(0, 0), progress.samples);
    samples.push_back(progress.samples);
    return true;
  };
  render_paths(bench.scene(), {.samples = 80}, pool, preview);
  EXPECT_EQ(samples, (std::vector<int>{4, 8, 16, 32, 64, 80}));
  const Film stopped = render_paths(
      bench.scene(), {.samples = 80}, pool, [](const PathProgress& p) { return p.pass < 2; });
  EXPECT_EQ(stopped.samples(0, 0), 8);
}

TEST(RenderPaths, MasksCostNoLightAndAreTheSameWithoutIt) {
  const PathBench bench = steel_gear();
  const Film lit = bench.render({.samples = 16});
  const Film dark = bench.render({.samples = 16, .has_light = false});
  EXPECT_EQ(lit.part, dark.part);
  EXPECT_EQ(lit.depth_mm, dark.depth_mm);
  EXPECT_EQ(lit.triangle, dark.triangle);
  EXPECT_EQ(dark.counts.shadow, 0);
  EXPECT_EQ(dark.counts.bounce, 0);
  EXPECT_GT(lit.counts.shadow, 0);
  EXPECT_TRUE(dark.groups.empty());
}

TEST(RenderPaths, SurfaceImagesOfAPlateAreThoseOfAPlate) {
  const PathBench bench(flat_plate(), matt(0.5), {}, small_camera());
  const Film sums = bench.render({.samples = 16, .has_light = false});
  const SurfaceImages images = surface_images(sums);
  // Top at z = 1, camera at z = 300: 299 mm along the axis; pixel (12, 3) looks at (4.5, 4.5) mm of
  // the plane z = 0 from 300 mm away, so at 4.5 * 299 / 300 = 4.485 mm on the top.
  EXPECT_NEAR(images.depth_mm(12, 3), 299.0F, 1e-3F);
  EXPECT_NEAR(images.x_mm(12, 3), 4.485F, 0.05F);
  EXPECT_NEAR(images.y_mm(12, 3), 4.485F, 0.05F);
  EXPECT_NEAR(images.z_mm(12, 3), 1.0F, 1e-5F);
  EXPECT_NEAR(images.normal_z(12, 3), 1.0F, 1e-6F);
  EXPECT_NEAR(images.incidence_rad(12, 3), std::atan(4.5F * std::sqrt(2.0F) / 300.0F), 2e-4F);
}

TEST(RenderPaths, RefusesSettingsOutOfTheirRange) {
  const PathBench bench(flat_plate(), matt(0.5), {}, small_camera());
  EXPECT_THROW(bench.render({.samples = 0}), ConfigError);
  EXPECT_THROW(bench.render({.max_reflections = 0}), ConfigError);
  EXPECT_THROW(bench.render({.channels = 2}), ConfigError);
  EXPECT_THROW(bench.render({.relative_error = -1.0}), ConfigError);
}

TEST(RenderPaths, WindowsAreMadeAsInTheWholePicture) {
  const PathBench bench(flat_plate(), matt(0.5), {ring_at(90.0)}, small_camera(0.5, 61, 45));
  PathSettings settings = {.samples = 8, .max_reflections = 1};
  const Film whole = bench.render(settings);
  settings.windows = {{.left_px = 18, .top_px = 9, .width_px = 20, .height_px = 3},
                      {.left_px = 50, .top_px = 30, .width_px = 11, .height_px = 15}};
  const Film windows = bench.render(settings, 2);
  const ImageF& light = windows.groups[0].channels[0];
  int lit = 0;
  for (int y = 0; y < windows.height_px; ++y) {
    for (int x = 0; x < windows.width_px; ++x) {
      // Cells of 8 x 8 pixels: 16 to 40 by 8 to 16, and 48 to the right border by 24 to the lower.
      const bool is_made = (x >= 16 && x < 40 && y >= 8 && y < 16) || (x >= 48 && y >= 24);
      ASSERT_EQ(windows.samples(x, y), is_made ? 8 : 0) << x << " " << y;
      EXPECT_EQ(light(x, y), is_made ? whole.groups[0].channels[0](x, y) : 0.0F);
      EXPECT_EQ(windows.triangle(x, y), is_made ? whole.triangle(x, y) : -1);
      EXPECT_EQ(windows.x_mm(x, y), is_made ? whole.x_mm(x, y) : 0.0F);
      lit += light(x, y) > 0.0F ? 1 : 0;
    }
  }
  EXPECT_GT(lit, 200);
}

}  // namespace
}  // namespace glint::path_test
