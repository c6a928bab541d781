// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/corner_rays.h"

#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/simulator/render/corner_rays/corner_bench.h"

namespace glint {
namespace {

using test::askew_plate;
using test::CornerBench;
using test::dent_at;
using test::kCornerCamera;
using test::same_bytes;
using test::small_strip;
using test::some_dents;

/// Adds features to rays traced without them and compares with tracing everything.
std::int64_t retraced_rays(const PartSettings& part,
                           const CameraSettings& camera,
                           const std::vector<HeightFeature>& features,
                           const RenderSettings& settings) {
  const CornerBench without(part, camera, {}, 1, settings);
  const CornerBench with(part, camera, features, 1, settings);
  ThreadPool pool(2);
  const RetracedRays retraced = retrace_detail(without.rays,
                                               with.part,
                                               with.bvh,
                                               with.detail,
                                               {with.camera, with.camera_from_world},
                                               settings,
                                               pool);
  EXPECT_TRUE(same_bytes(with.rays, retraced.rays));
  EXPECT_FALSE(same_bytes(without.rays, retraced.rays));
  return retraced.traced;
}

TEST(RetraceDetail, IsTheSameBytesAsTracingAStripWithItsDents) {
  const std::vector<HeightFeature> dents = some_dents(small_strip());
  retraced_rays(small_strip(), kCornerCamera, dents, {});
  // One dent: little more than the rays of its refined pixels.
  const CornerBench with(small_strip(), kCornerCamera, {dents.front()});
  const std::int64_t traced = retraced_rays(small_strip(), kCornerCamera, {dents.front()}, {});
  EXPECT_LT(traced, with.rays.counts.camera / 2);
}

TEST(RetraceDetail, IsTheSameBytesAsTracingStainsAndDentsThatOverlap) {
  std::vector<HeightFeature> features = some_dents(small_strip());
  for (const std::size_t i : {0U, 3U}) {
    HeightFeature stain = features[i];
    stain.id = static_cast<int>(10 + i);
    stain.height_mm = 0.0;
    stain.sigma_mm *= 1.5;
    stain.reflectance = 0.3;
    stain.roughness_rad = i == 0 ? 5e-3 : 0.0;
    features.push_back(stain);
  }
  retraced_rays(small_strip(), kCornerCamera, features, {});
  retraced_rays(askew_plate(), kCornerCamera, features, {.reflectance = 0.7});
}

TEST(RetraceDetail, IsTheSameBytesWhereSilhouettesAreInTheImage) {
  std::vector<HeightFeature> dents = some_dents(askew_plate());
  dents.front().moves_position = true;
  retraced_rays(askew_plate(), kCornerCamera, dents, {});
}

// Light that comes by way of a flank with a dent: pixels far from the dent change.
TEST(RetraceDetail, IsTheSameBytesOnAGearWhoseTeethReflectEachOther) {
  PartSettings gear;
  gear.shape = PartSettings::Shape::kSpurGear;
  const CameraSettings camera = {
      .width_px = 80, .height_px = 60, .object_pixel_mm = 0.4, .working_distance_mm = 300.0};
  const Part part = build_part(gear);
  const Bvh bvh(part.mesh);
  std::vector<HeightFeature> dents;
  for (const auto& [x_mm, y_mm] :
       {std::pair(-5.0, -8.0), std::pair(0.0, 3.0), std::pair(4.0, 9.5)}) {
    dents.push_back(dent_at(part, bvh, x_mm, y_mm, 0.5));
  }
  for (const double reflectance : {1.0, 0.0}) {
    const RenderSettings settings = {.max_bounces = 4, .reflectance = reflectance};
    const CornerBench with(gear, camera, dents, 1, settings);
    const std::int64_t traced = retraced_rays(gear, camera, dents, settings);
    EXPECT_GT(with.rays.counts.followed, 0);
    EXPECT_LT(traced, with.rays.counts.camera);
  }
}

TEST(RetraceDetail, TracesNothingForADefectOutsideTheImage) {
  HeightFeature far = test::bump(0.02);
  far.centre_mm = {29.0, 19.0, 1.0};
  const CornerBench without(test::plate(), kCornerCamera);
  const CornerBench with(test::plate(), kCornerCamera, {far});
  ThreadPool pool(1);
  const RetracedRays retraced = retrace_detail(without.rays,
                                               with.part,
                                               with.bvh,
                                               with.detail,
                                               {with.camera, with.camera_from_world},
                                               {},
                                               pool);
  EXPECT_TRUE(same_bytes(with.rays, retraced.rays));
  EXPECT_EQ(retraced.traced, 0);
}

}  // namespace
}  // namespace glint
