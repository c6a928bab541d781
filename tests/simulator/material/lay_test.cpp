// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/lay.h"

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Kind = LaySettings::Kind;

Vector3d groove(const LaySettings& settings, const Vector3d& point_mm) {
  return groove_at(settings, plane_of(settings), point_mm);
}

TEST(Groove, OfATurnedPartRunsAroundItsAxis) {
  const LaySettings turned = {.kind = Kind::kTurned};
  EXPECT_LT((groove(turned, {3, 4, 7}) - Vector3d(-0.8, 0.6, 0)).norm(), 1e-12);
  EXPECT_EQ(groove(turned, {0, 0, 7}).norm(), 0.0);
  const LaySettings about_x = {
      .kind = Kind::kTurned, .center_mm = {5, 1, 0}, .axis = {2, 0, 0}, .direction = {0, 1, 0}};
  EXPECT_LT((groove(about_x, {0, 4, 4}) - Vector3d(0, -0.8, 0.6)).norm(), 1e-12);
}

TEST(Groove, OfABrushedPartIsItsDirection) {
  const LaySettings brushed = {.kind = Kind::kBrushed, .direction = {3, 4, 0}};
  EXPECT_LT((groove(brushed, {9, -2, 1}) - Vector3d(0.6, 0.8, 0)).norm(), 1e-12);
}

// 3 mm beside the lane's middle the edge of a mill of 5 mm stands 4 mm ahead: groove (-3, 4) / 5.
TEST(Groove, OfAMilledPartIsTheMillsArc) {
  const LaySettings milled = {.kind = Kind::kMilled, .mill_radius_mm = 5, .lane_mm = 10};
  for (const double y : {3.0, 13.0, -7.0, 103.0}) {
    EXPECT_LT((groove(milled, {8, y, 0}) - Vector3d(-0.6, 0.8, 0)).norm(), 1e-12) << y;
  }
  EXPECT_LT((groove(milled, {8, 0, 0}) - Vector3d(0, 1, 0)).norm(), 1e-12);
}

TEST(Groove, LiesAcrossTheAxisAndHasLengthOne) {
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    LaySettings lay = {.kind = static_cast<Kind>(i % 4), .mill_radius_mm = 20, .lane_mm = 40};
    lay.axis = {rng.normal(), rng.normal(), rng.normal()};
    lay.direction = {rng.normal(), rng.normal(), rng.normal()};
    const LayPlane plane = plane_of(lay);
    const Vector3d point_mm(rng.uniform(-90, 90), rng.uniform(-90, 90), rng.uniform(-90, 90));
    const Vector3d along = groove_at(lay, plane, point_mm);
    EXPECT_NEAR(along.norm(), 1.0, 1e-12);
    EXPECT_NEAR(along.dot(plane.axis), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace glint
