// SPDX-License-Identifier: GPL-3.0-or-later
//
// Views refused as unreachable, tried by another solver: KDL's after Levenberg and Marquardt, from
// 200 random starts each.
#include <gtest/gtest.h>
#include <kdl/chainiksolverpos_lma.hpp>

#include "core/rng.h"
#include "hardware/planning/joint_choices.h"
#include "tests/hardware/planning/planned_cell.h"
#include "tests/hardware/robot/kinematics/arm_poses.h"
#include "tests/hardware/robot/kinematics/kdl_arm.h"

namespace glint {
namespace {

/// Joints that KDL finds from one of 200 starts.
bool finds_joints(const Arm& arm,
                  KDL::ChainIkSolverPos_LMA& solver,
                  const Eigen::Isometry3d& pose,
                  std::uint64_t seed) {
  constexpr std::uint64_t kStarts = 200;
  KDL::JntArray start(6);
  KDL::JntArray result(6);
  for (std::uint64_t k = 0; k < kStarts; ++k) {
    start.data = random_joints(1000 * seed + k);
    if (solver.CartToJnt(start, test::frame_of(pose), result) >= 0 &&
        test::reaches(arm, JointVector(result.data), pose)) {
      return true;
    }
  }
  return false;
}

TEST(UnreachableViews, HaveNoJointsByAnotherSolverEither) {
  const PlanningCell cell = planned_cell();
  const ClearanceCheck clearance(cell);
  const Arm& arm = cell.arm.arm;
  const KDL::Chain chain = test::chain_of(arm);
  KDL::ChainIkSolverPos_LMA solver(chain, 1e-7, 200);
  int refused = 0;
  int reachable = 0;
  for (std::uint64_t i = 0; refused < 40; ++i) {
    // Around the border of the arm's reach, where a wrong refusal would be.
    Rng rng(3, Stream::kTest, i);
    Eigen::Isometry3d flange = arm.forward(random_joints(i));
    flange.translation() *= rng.uniform(0.9, 1.4);
    const JointChoices choices = choices_of(cell, clearance, flange);
    if (choices.outcome == ViewOutcome::kUnreachable) {
      ++refused;
      EXPECT_FALSE(finds_joints(arm, solver, flange, i)) << i;
    } else if (reachable < 20) {
      ++reachable;
      EXPECT_TRUE(finds_joints(arm, solver, flange, i)) << "what is reachable is found, " << i;
    }
  }
  EXPECT_EQ(reachable, 20);
}

}  // namespace
}  // namespace glint
