// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/kinematics/arm.h"

#include <gtest/gtest.h>

#include "core/units.h"
#include "tests/hardware/robot/kinematics/arm_poses.h"

namespace glint {
namespace {

// All angles 0: the links lie along -x (a2 + a3), the wrist's offset and the flange along -y
// (d4 + d6), joint 5's offset along -z: z = d1 - d5.
TEST(Arm, FlangeOfTheStretchedArmIsTheSumOfItsLengths) {
  const Eigen::Isometry3d ur3 = Arm(ArmModel::kUr3).forward(JointVector::Zero());
  EXPECT_NEAR(ur3.translation().x(), -243.65 - 213.25, 1e-9);
  EXPECT_NEAR(ur3.translation().y(), -112.35 - 81.9, 1e-9);
  EXPECT_NEAR(ur3.translation().z(), 151.9 - 85.35, 1e-9);
  const Eigen::Isometry3d ur5e = Arm(ArmModel::kUr5e).forward(JointVector::Zero());
  EXPECT_NEAR(ur5e.translation().x(), -425.0 - 392.2, 1e-9);
  EXPECT_NEAR(ur5e.translation().y(), -133.3 - 99.6, 1e-9);
  EXPECT_NEAR(ur5e.translation().z(), 162.5 - 99.7, 1e-9);
}

TEST(Arm, JacobianAgreesWithCentralDifferences) {
  constexpr double kStep = 1e-5;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Arm arm(i % 2 == 0 ? ArmModel::kUr3e : ArmModel::kUr5e,
                  i % 2 == 0 ? typical_deltas(ArmModel::kUr3e) : ArmDeltas{});
    const JointVector joints_rad = random_joints(i);
    const ArmJacobian jacobian = arm.jacobian(joints_rad);
    for (int k = 0; k < 6; ++k) {
      const JointVector step = kStep * JointVector::Unit(k);
      const JointVector difference =
          pose_difference(arm.forward(joints_rad + step), arm.forward(joints_rad - step)) /
          (2.0 * kStep);
      EXPECT_LT((difference - jacobian.col(k)).head<3>().norm(), 1e-6);
      EXPECT_LT((difference - jacobian.col(k)).tail<3>().norm(), 1e-8);
    }
  }
}

// Healthy, with joint 5 and with joint 3 at 1e-3 rad: the reference measured 0.11, 2e-4 and 9e-5.
TEST(SingularityMeasure, IsSmallWhereTheFlangeCannotMoveEveryWay) {
  const Arm arm(ArmModel::kUr3);
  const auto measure = [&arm](double joint3, double joint5) {
    const JointVector joints_rad{0.1, -1.2, joint3, -1.7, joint5, 0.2};
    return singularity_measure(arm.jacobian(joints_rad));
  };
  EXPECT_NEAR(measure(1.4, -1.5), 0.11, 0.01);
  EXPECT_NEAR(measure(1.4, 1e-3), 2e-4, 1e-4);
  EXPECT_NEAR(measure(1e-3, -1.5), 9e-5, 2e-5);
}

TEST(NearestTurns, StayWithinTheJointsLimit) {
  const JointVector solution_rad = JointVector::Constant(3.0);
  const JointVector near = nearest_turns(solution_rad, JointVector::Constant(-3.2), 2.0 * kPi);
  EXPECT_NEAR(near[0], 3.0 - 2.0 * kPi, 1e-12);
  const JointVector high = nearest_turns(solution_rad, JointVector::Constant(6.2), 2.0 * kPi);
  EXPECT_NEAR(high[0], 3.0, 1e-12) << "3 + 2 pi is beyond the limit";
}

}  // namespace
}  // namespace glint
