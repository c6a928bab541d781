// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/embree_recorder.h"

#include <gtest/gtest.h>

#include "simulator/geometry/bvh/bvh.h"

namespace glint::bench {
namespace {

/// One triangle in z = 0 over (0, 0), (1, 0), (0, 1).
TriangleMesh triangle() {
  TriangleMesh mesh;
  mesh.vertices_mm = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Five rays straight down from z = 1, at x = y = 0.1, 0.35, ... 1.1: the first two meet it.
RayPacket five_rays() {
  RayPacket rays;
  for (std::size_t k = 0; k < 5; ++k) {
    rays.origin_x[k] = rays.origin_y[k] = 0.1F + 0.25F * static_cast<float>(k);
    rays.origin_z[k] = 1.0F;
    rays.direction_z[k] = -1.0F;
    rays.t_max[k] = 2.0F;
    rays.valid[k] = -1;
  }
  return rays;
}

TEST(EmbreeRecorder, TakesDownWhatTheBvhAsks) {
  const Bvh bvh(triangle());
  EmbreeRecord record;
  RayPacket rays = five_rays();
  HitPacket hits;
  {
    const EmbreeRecording recording(record);
    bvh.intersect16(rays, hits, Coherence::kCoherent);
    bvh.occluded16(rays, Coherence::kIncoherent);
  }
  bvh.intersect16(five_rays(), hits, Coherence::kCoherent);  // is not recorded

  ASSERT_EQ(record.packets.size(), 2U);
  EXPECT_EQ(record.num_retries, 1);  // the three that missed, a little aside
  EXPECT_FALSE(record.packets[0].is_occlusion);
  EXPECT_TRUE(record.packets[0].is_coherent);
  EXPECT_TRUE(record.packets[1].is_occlusion);
  EXPECT_FALSE(record.packets[1].is_coherent);
  for (const RecordedPacket& packet : record.packets) {
    EXPECT_EQ(packet.num_rays(), 5);
    EXPECT_FLOAT_EQ(packet.origin_x[4], 1.1F);
  }
}

TEST(EmbreeRecorder, PassesCallsOn) {
  const Bvh bvh(triangle());
  EmbreeRecord record;
  RayPacket rays = five_rays();
  HitPacket hits;
  {
    const EmbreeRecording recording(record);
    bvh.intersect16(rays, hits, Coherence::kCoherent);
    bvh.occluded16(rays, Coherence::kCoherent);
  }
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(hits.triangle[k], k < 2 ? 0 : -1) << k;
    EXPECT_EQ(rays.valid[k], k < 2 ? 0 : -1) << k;
  }
  ASSERT_EQ(record.packets.size(), 2U);
  // Asked again, the first ray ends on the triangle, and the first that is occluded at -infinity.
  EXPECT_FLOAT_EQ(ask_again(record.scene, {record.packets[0]}, Asking::kAsRecorded), 1.0F);
  EXPECT_LT(ask_again(record.scene, {record.packets[1]}, Asking::kAsRecorded), 0.0F);
}

}  // namespace
}  // namespace glint::bench
