// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/ray_cache/ray_cache.h"
#include "tests/simulator/render/path_tracing/path_bench.h"

namespace glint::path_test {
namespace {

/// Brighter to one side, without hard edges: a mirror's picture of it converges quickly.
Lights soft_sky() {
  constexpr int kWidth = 64;
  constexpr int kHeight = 32;
  std::vector<std::array<float, 3>> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float level = 1.0F + 0.5F * std::sin(0.2F * static_cast<float>(y)) +
                          0.3F * std::cos(0.0981748F * static_cast<float>(x));
      pixels.push_back({level, 0.5F * level, 0.25F * level});
    }
  }
  Lights lights;
  lights.environment = Environment(kWidth, kHeight, std::move(pixels));
  lights.environment_group = 0;
  lights.groups.push_back({.name = "sky"});
  return lights;
}

PartSettings bent_strip() {
  return {.shape = PartSettings::Shape::kStrip,
          .length_mm = 60.0,
          .width_mm = 30.0,
          .radius_along_mm = 80.0,
          .radius_across_mm = 60.0};
}

PathBench under_soft_sky(const MaterialSettings& material) {
  PathBench bench(bent_strip(), material, {}, small_camera(1.0, 40, 20));
  bench.lights = soft_sky();
  return bench;
}

/// Level 0 of the same picture: reflected rays looked up in the sky.
ImageF mirrored_sky(const PathBench& bench) {
  ThreadPool pool(1);
  RenderSettings settings;
  settings.rays_per_axis = 8;
  const RayCache rays =
      trace_rays(bench.part, bench.bvh, bench.detail, bench.camera, bench.pose, settings, pool);
  ImageF image(rays.width_px, rays.height_px);
  for (std::size_t p = 0; p < image.size(); ++p) {
    double sum = 0.0;
    for (int s = 0; s < rays.samples; ++s) {
      const std::size_t i = static_cast<std::size_t>(s) * image.size() + p;
      const Eigen::Vector3d to =
          vector_of(rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]).normalized();
      sum += static_cast<double>(rays.weight[i] * bench.lights.environment->radiance(to)[0]);
    }
    image.values()[p] = static_cast<float>(sum / rays.samples);
  }
  return image;
}

TEST(Mirror, ShowsTheSameSkyAsLevel0) {
  const PathBench bench = under_soft_sky(white_mirror());
  const ImageF picture = bench.picture({.samples = 64, .max_reflections = 4});
  const ImageF level0 = mirrored_sky(bench);
  EXPECT_LT(rms_difference(picture, level0), 0.005);
  EXPECT_NEAR(mean_of(picture), mean_of(level0), 5e-4);
}

TEST(Metal, AlmostSmoothIsAMirror) {
  const PathSettings settings = {.samples = 64, .max_reflections = 4};
  const ImageF mirror = under_soft_sky(white_mirror()).picture(settings);
  const ImageF narrow = under_soft_sky(white_metal({1e-4, 1e-4})).picture(settings);
  const ImageF wide = under_soft_sky(white_metal({0.3, 0.3})).picture(settings);
  EXPECT_LT(rms_difference(narrow, mirror), 0.005);
  EXPECT_GT(rms_difference(wide, mirror), 0.05);  // the comparison can tell
}

TEST(LightGroups, TwoLightsAreTheSumOfSingles) {
  const PathSettings settings = {.samples = 256};
  const MaterialSettings steel = {.type = MaterialSettings::Type::kConductor, .reflectance = {0.6}};
  const auto mean_with = [&](const std::vector<NamedLight>& lights) {
    return mean_of(PathBench(bent_strip(), steel, lights, small_camera(2.0)).picture(settings));
  };
  const double both = mean_with({ring_at(100.0), bar_aside()});
  const double sum = mean_with({ring_at(100.0)}) + mean_with({bar_aside()});
  EXPECT_GT(both, 0.01);
  EXPECT_NEAR(both, sum, 0.01 * both);
}

TEST(LightGroups, FactorsDoNotChangeTheGroupsThemselves) {
  PathBench bench(bent_strip(), matt(0.5), {ring_at(100.0), bar_aside()}, small_camera(2.0));
  const Film before = bench.render({.samples = 8});
  bench.lights.groups[0].factor = 7.0;
  const Film after = bench.render({.samples = 8});
  EXPECT_EQ(before.groups[0].channels, after.groups[0].channels);
  EXPECT_EQ(before.groups[1].channels, after.groups[1].channels);
}

TEST(Paths, DirectLightAloneIsDarkerInAConcavePart) {
  PartSettings bowl = bent_strip();
  bowl.radius_along_mm = -40.0;
  bowl.radius_across_mm = -40.0;
  const PathBench bench(bowl, matt(0.8), {white_sky()}, small_camera());
  const double once = mean_of(bench.picture({.samples = 64, .max_reflections = 1}));
  const double often = mean_of(bench.picture({.samples = 64, .max_reflections = 16}));
  EXPECT_GT(often, 1.02 * once);
  EXPECT_LT(often, 1.0);
}

TEST(Paths, PartTurnedInsideOutLooksTheSame) {
  const auto tent = [](bool is_turned) {
    Part part;
    part.mesh.vertices_mm = {{-20, -10, 0}, {20, -10, 0}, {20, 10, 0}, {-20, 10, 0}, {0, 0, 8}};
    part.mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 3, 2}, {0, 2, 1}};
    for (Triangle& triangle : part.mesh.triangles) {
      if (is_turned) {
        std::swap(triangle[1], triangle[2]);
      }
    }
    smooth_normals(part.mesh, 0.1);
    const CameraSettings camera = small_camera(2.0);
    const PathBench bench(
        std::move(part), matt(0.5), {ring_at(100.0)}, camera, default_viewpoint(camera));
    return mean_of(bench.picture({.samples = 64}));
  };
  EXPECT_GT(tent(false), 1e-3);
  EXPECT_NEAR(tent(true), tent(false), 0.02 * tent(false));
}

TEST(ThinLens, BlursWhatIsNotInFocus) {
  const auto edge_with = [](const ThinLens& lens) {
    PathBench bench(flat_plate(), matt(0.5), {}, small_camera(1.0, 80, 16));
    bench.lens = lens;
    const Film sums = bench.render({.samples = 64, .has_light = false});
    const ImageF coverage = coverage_images(sums).sound;
    int partial = 0;
    for (int x = 0; x < 80; ++x) {
      partial += coverage(x, 8) > 0.02F && coverage(x, 8) < 0.98F ? 1 : 0;
    }
    return partial;
  };
  EXPECT_LE(edge_with({}), 2);
  EXPECT_LE(edge_with({.aperture_mm = 20.0, .focus_mm = 299.0}), 2);
  // At half the distance in focus the circle of confusion is as wide as the aperture, 20 mm.
  EXPECT_GE(edge_with({.aperture_mm = 20.0, .focus_mm = 150.0}), 30);
}

}  // namespace
}  // namespace glint::path_test
