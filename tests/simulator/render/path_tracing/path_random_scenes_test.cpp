// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "core/rng.h"
#include "tests/simulator/render/path_tracing/path_bench.h"

namespace glint::path_test {
namespace {

using Eigen::Vector3d;

Vector3d random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

/// A soup of triangles turned either way, some needles, some without area, from 0.1 to 100 mm.
Part random_part(Rng& rng) {
  Part part;
  const double size_mm = std::pow(10.0, rng.uniform(-1.0, 2.0));
  const auto count = static_cast<std::int32_t>(1 + rng.next_u32() % 20);
  for (std::int32_t i = 0; i < count; ++i) {
    const Vector3d a = random_vector(rng, size_mm);
    const Vector3d b = random_vector(rng, size_mm);
    const bool is_flat = rng.uniform() < 0.1;
    const bool is_needle = rng.uniform() < 0.1;
    Vector3d c = is_flat ? Vector3d(0.5 * (a + b)) : random_vector(rng, size_mm);
    c = is_needle ? Vector3d(a + 1e-6 * c) : c;
    part.mesh.vertices_mm.insert(part.mesh.vertices_mm.end(), {a, b, c});
    part.mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  smooth_normals(part.mesh, rng.uniform(0.0, 1.5));
  part.scene_from_part.rotation =
      Eigen::AngleAxisd(rng.uniform(0.0, 6.0), random_vector(rng, 1.0).normalized())
          .toRotationMatrix();
  return part;
}

std::vector<MaterialSettings> some_materials() {
  MaterialSettings coated = matt(0.7, 0.5);
  coated.coat.index = 1.5;
  MaterialSettings turned = white_metal({0.3, 0.05});
  turned.lay.kind = LaySettings::Kind::kTurned;
  MaterialSettings patterned = white_metal({0.2, 0.2});
  patterned.pattern.kind = PatternSettings::Kind::kConcentric;
  return {white_mirror(), white_metal({1e-4, 1e-4}), turned, patterned, matt(1.0), coated};
}

std::vector<NamedLight> random_lights(Rng& rng) {
  std::vector<NamedLight> lights;
  if (rng.uniform() < 0.5) {
    lights.push_back(white_sky(rng.uniform(0.0, 2.0)));
  }
  if (rng.uniform() < 0.5) {
    lights.push_back(ring_at(rng.uniform(-20.0, 200.0)));
  }
  if (rng.uniform() < 0.5) {
    lights.push_back(bar_aside());
  }
  if (lights.empty()) {
    lights.push_back({.name = "dome", .settings = DomeSettings{}});
  }
  return lights;
}

HeightFeature random_feature(Rng& rng, const Part& part, int id) {
  const std::size_t triangle = rng.next_u32() % part.mesh.num_triangles();
  HeightFeature feature;
  feature.id = id;
  feature.centre_mm = (part.mesh.vertex(triangle, 0) + part.mesh.vertex(triangle, 1) +
                       part.mesh.vertex(triangle, 2)) /
                      3.0;
  const ShadingFrame frame = frame_at(face_normal(part.mesh, triangle).squaredNorm() > 0.5
                                          ? face_normal(part.mesh, triangle)
                                          : Vector3d::UnitZ(),
                                      Vector3d::UnitX());
  feature.u_axis = frame.tangent;
  feature.v_axis = frame.bitangent;
  feature.normal = frame.normal;
  feature.sigma_mm = std::pow(10.0, rng.uniform(-1.0, 1.5));
  feature.height_mm = rng.uniform(-0.3, 0.3) * feature.sigma_mm;
  feature.moves_position = rng.uniform() < 0.3;
  feature.reflectance = rng.uniform();
  return feature;
}

PathBench random_bench(Rng& rng, const std::vector<MaterialSettings>& materials) {
  const Vector3d direction = random_vector(rng, 1.0).normalized();
  const double distance_mm = std::pow(10.0, rng.uniform(0.0, 2.5));
  const Vector3d position = -distance_mm * direction;
  const Vector3d up = direction.unitOrthogonal();
  PathBench bench(random_part(rng),
                  materials[rng.next_u32() % materials.size()],
                  random_lights(rng),
                  small_camera(rng.uniform(1.0, 30.0), 9, 7),
                  {.position_mm = {position.x(), position.y(), position.z()},
                   .direction = {direction.x(), direction.y(), direction.z()},
                   .up = {up.x(), up.y(), up.z()}});
  std::vector<HeightFeature> features;
  for (int id = 0; id < 3; ++id) {
    features.push_back(random_feature(rng, bench.part, id));
  }
  bench.detail = SurfaceDetail(std::move(features));
  for (std::size_t i = 0; i < bench.part.mesh.num_triangles(); ++i) {
    bench.labels.push_back(static_cast<std::int32_t>(rng.next_u32() % 5));
  }
  return bench;
}

bool is_proper(const ImageF& image) {
  return std::ranges::all_of(image.values(), [](float v) { return std::isfinite(v) && v >= 0.0F; });
}

/// background + sound + defects = 1, and no share below 0.
bool is_partition(const CoverageImages& images) {
  for (std::size_t i = 0; i < images.sound.size(); ++i) {
    float sum = images.background.values()[i] + images.sound.values()[i];
    bool is_share = images.background.values()[i] >= 0.0F && images.sound.values()[i] >= 0.0F;
    for (const ImageF& defect : images.defects) {
      sum += defect.values()[i];
      is_share = is_share && defect.values()[i] >= 0.0F;
    }
    if (!is_share || std::abs(sum - 1.0F) > 1e-6F) {
      return false;
    }
  }
  return true;
}

TEST(RandomScenes, HaveNoBadPixelAndTheirMasksAreAPartition) {
  const std::vector<MaterialSettings> materials = some_materials();
  Rng rng(7, Stream::kTest, 0);
  int lit = 0;
  int with_defect = 0;
  for (int scene = 0; scene < 1000; ++scene) {
    const PathBench bench = random_bench(rng, materials);
    const Film sums = bench.render({.samples = 4});
    ASSERT_EQ(sums.counts.dropped, 0) << scene;
    const ImageF total = total_image(sums, group_factors(bench.lights), 0);
    ASSERT_TRUE(is_proper(total)) << scene;
    ASSERT_TRUE(is_proper(standard_error_image(sums, group_factors(bench.lights)))) << scene;
    const SurfaceImages surface = surface_images(sums);
    ASSERT_TRUE(is_proper(surface.incidence_rad)) << scene;
    const CoverageImages coverage = coverage_images(sums);
    ASSERT_TRUE(is_partition(coverage)) << scene;
    lit += mean_of(total) > 0.0 ? 1 : 0;
    with_defect += std::ranges::any_of(coverage.defects,
                                       [](const ImageF& image) { return mean_of(image) > 0.0; });
  }
  EXPECT_GT(lit, 700);
  EXPECT_GT(with_defect, 300);
}

TEST(RandomScenes, PartitionCheckCanFail) {
  PathBench bench(flat_plate(), matt(0.5), {}, small_camera(10.0));
  bench.labels.assign(bench.part.mesh.num_triangles(), 3);
  CoverageImages coverage = coverage_images(bench.render({.samples = 4, .has_light = false}));
  EXPECT_TRUE(is_partition(coverage));
  EXPECT_GT(mean_of(coverage.defects.at(0)), 0.05);
  coverage.defects.clear();
  EXPECT_FALSE(is_partition(coverage));
}

}  // namespace
}  // namespace glint::path_test
