// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/kinematics/link_shapes.h"

#include <gtest/gtest.h>

#include "tests/hardware/robot/kinematics/arm_poses.h"

namespace glint {
namespace {

// All angles 0: axes of joints 2 to 4 point along -y, so the upper arm lies at y = -120, the
// forearm at y = -27, and the tool of 100 mm along the flange's z goes on along -y.
TEST(ArmShape, LinksOfTheStretchedArmLieWhereTheDrawingHasThem) {
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  tool.translation().z() = 100.0;
  const ArmShape shape = arm_shape(Arm(ArmModel::kUr3), JointVector::Zero(), tool, 30.0);
  EXPECT_LT((shape[1].from_mm - Eigen::Vector3d(0.0, -120.0, 151.9)).norm(), 1e-9);
  EXPECT_LT((shape[1].to_mm - Eigen::Vector3d(-243.65, -120.0, 151.9)).norm(), 1e-9);
  EXPECT_LT((shape[3].to_mm - Eigen::Vector3d(-456.9, -27.0, 151.9)).norm(), 1e-9);
  EXPECT_LT((shape[7].to_mm - Eigen::Vector3d(-456.9, -294.25, 66.55)).norm(), 1e-9);
  EXPECT_EQ(shape[7].radius_mm, 30.0);
}

TEST(ArmShape, IsOneChainWithinItsReach) {
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  tool.translation() = Eigen::Vector3d(10.0, -20.0, 80.0);
  for (const ArmModel model : {ArmModel::kUr3, ArmModel::kUr5e}) {
    const Arm arm(model, typical_deltas(model));
    const double reach_mm = farthest_reach_mm(arm, tool, 25.0);
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const ArmShape shape = arm_shape(arm, random_joints(i), tool, 25.0);
      for (std::size_t k = 1; k < shape.size(); ++k) {
        EXPECT_LT((shape[k].from_mm - shape[k - 1].to_mm).norm(), 1e-9);
        EXPECT_LT(shape[k].to_mm.norm() + shape[k].radius_mm, reach_mm);
      }
    }
  }
}

}  // namespace
}  // namespace glint
