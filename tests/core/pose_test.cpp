// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/pose.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

RigidTransform random_transform(Rng& rng) {
  Eigen::Vector3d axis(rng.normal(), rng.normal(), rng.normal());
  axis.normalize();
  return {.rotation = Eigen::AngleAxisd(rng.uniform(-kPi, kPi), axis).toRotationMatrix(),
          .translation_mm = Eigen::Vector3d(
              rng.uniform(-500, 500), rng.uniform(-500, 500), rng.uniform(-500, 500))};
}

// A quarter turn about z takes +x to +y: (10, 0, 5) -> (0, 10, 5), then the shift adds (1, 2, 3).
TEST(RigidTransform, TurnsThenShiftsAHandWorkedPoint) {
  const RigidTransform camera_from_world = {
      .rotation = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
      .translation_mm = {1, 2, 3}};
  const Eigen::Vector3d point_in_camera_mm = camera_from_world * Eigen::Vector3d(10, 0, 5);
  EXPECT_LT((point_in_camera_mm - Eigen::Vector3d(1, 12, 8)).norm(), 1e-12);
}

TEST(RigidTransform, ChainsAndInvertsForAnyMotion) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(1, Stream::kTest, i);
    const RigidTransform a_from_b = random_transform(rng);
    const RigidTransform b_from_c = random_transform(rng);
    const Eigen::Vector3d point_in_c_mm(rng.normal(), rng.normal(), rng.normal());
    const Eigen::Vector3d point_in_a_mm = a_from_b * (b_from_c * point_in_c_mm);
    ASSERT_LT(((a_from_b * b_from_c) * point_in_c_mm - point_in_a_mm).norm(), 1e-9);
    ASSERT_LT((inverse(a_from_b * b_from_c) * point_in_a_mm - point_in_c_mm).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace glint
