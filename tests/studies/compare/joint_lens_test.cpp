// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/fit/joint_lens.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kDistanceAt = 5;
constexpr std::size_t kFocalAt = 6;
constexpr std::size_t kK1At = 9;

PinholeIntrinsics camera_of_views() {
  return {.width_px = 1224,
          .height_px = 1025,
          .focal_px = {1740.0, 1740.0},
          .center_px = {612.0, 512.5}};
}

/// Edges of a part at some distance that reaches in depth as far as `depth_mm`.
LensView view_of(const CauseVector& changes,
                 double distance_mm,
                 double depth_mm,
                 std::uint64_t index) {
  constexpr double kNoise_px = 0.05;
  const PinholeIntrinsics camera = camera_of_views();
  LensView view = {.middle_mm = {0.0, 0.0, distance_mm}, .noise_px = kNoise_px};
  Rng rng(22, Stream::kTest, index);
  for (int i = 0; i < 1500; ++i) {
    const double angle = rng.uniform(0.0, 2.0 * kPi);
    const double scale = distance_mm / 150.0;
    SpaceEdge edge = {.in_camera_mm = {scale * rng.uniform(-48.0, 48.0),
                                       scale * rng.uniform(-40.0, 40.0),
                                       distance_mm + rng.uniform(-depth_mm, depth_mm)},
                      .normal = {std::cos(angle), std::sin(angle)}};
    const Vector2d moved = changed_pixel(camera, view.middle_mm, changes, edge.in_camera_mm) -
                           changed_pixel(camera, view.middle_mm, CauseVector{}, edge.in_camera_mm);
    edge.offset_px = moved.dot(edge.normal) + kNoise_px * rng.normal();
    view.edges.push_back(edge);
  }
  return view;
}

CauseVector with_lens(CauseVector pose, double focal_px, double k1) {
  pose[kFocalAt] = focal_px;
  pose[kK1At] = k1;
  return pose;
}

// The first view is of a flat part: by itself it could not tell 8 px of focal length from 0.7 mm of
// distance. The others have depth, and there is one lens.
TEST(FitJointLens, TellsDistanceFromFocalLengthByTheOtherViews) {
  const std::vector<CauseVector> truth = {with_lens({0.0, 0.0, 0.002, 0.05, 0.0, 0.3}, 8.0, 0.02),
                                          with_lens({0.003, 0.0, 0.0, 0.0, -0.04, 0.0}, 8.0, 0.02),
                                          with_lens({0.0, -0.004, 0.0, 0.0, 0.0, -0.2}, 8.0, 0.02)};
  const std::vector<LensView> views = {view_of(truth[0], 150.0, 0.0, 1),
                                       view_of(truth[1], 180.0, 25.0, 2),
                                       view_of(truth[2], 130.0, 25.0, 3)};
  const std::vector<CauseParameter> lens = {CauseParameter::kFocalLength, CauseParameter::kK1};
  const auto found = fit_joint_lens(views, camera_of_views(), lens);
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found[i][kFocalAt], found[0][kFocalAt]);
    EXPECT_EQ(found[i][kFocalAt + 1], 0.0);  // the centre was not free
    EXPECT_NEAR(found[i][kDistanceAt], truth[i][kDistanceAt], 0.1);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(found[i][k], truth[i][k], 5e-4);
    }
  }
  EXPECT_NEAR(found[0][kFocalAt], 8.0, 1.0);
  EXPECT_NEAR(found[0][kK1At], 0.02, 0.003);
}

TEST(FitJointLens, LeavesALensThatMayNotChange) {
  const CauseVector pose = {0.0, 0.0, 0.002, 0.05, 0.0, 0.3};
  const std::vector<LensView> views = {view_of(pose, 150.0, 15.0, 1)};
  const auto found = fit_joint_lens(views, camera_of_views(), {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0][kFocalAt], 0.0);
  EXPECT_NEAR(found[0][kDistanceAt], 0.3, 0.02);
  EXPECT_TRUE(fit_joint_lens({}, camera_of_views(), {}).empty());
}

}  // namespace
}  // namespace glint
