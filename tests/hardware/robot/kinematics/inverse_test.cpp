// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <gtest/gtest.h>

#include "core/units.h"
#include "hardware/robot/kinematics/arm.h"
#include "tests/hardware/robot/kinematics/arm_poses.h"
#include "tests/support/count_from.h"

namespace glint {
namespace {

std::uint64_t num_poses() {
  return static_cast<std::uint64_t>(count_from("GLINT_NUM_POSES", 2000));
}

constexpr std::array<ArmModel, 3> kModels = {ArmModel::kUr3, ArmModel::kUr3e, ArmModel::kUr5e};

/// Every solution reaches the pose, all differ, and the joints that made the pose are among them.
void expect_all_branches(const Arm& arm, const JointVector& joints_rad) {
  const Eigen::Isometry3d pose = arm.forward(joints_rad);
  const ArmSolutions solutions = arm.inverse(pose);
  double nearest_rad = 10.0;
  for (const JointVector& solution_rad : solutions) {
    const JointVector left = pose_difference(arm.forward(solution_rad), pose);
    EXPECT_LT(left.head<3>().norm(), 1e-9);
    EXPECT_LT(left.tail<3>().norm(), 1e-9);
    nearest_rad = std::min(nearest_rad, joint_distance_rad(solution_rad, joints_rad));
  }
  EXPECT_LT(nearest_rad, 1e-6) << joints_rad.transpose();
  for (int i = 0; i < solutions.size(); ++i) {
    for (int k = 0; k < i; ++k) {
      EXPECT_GT(joint_distance_rad(solutions[i], solutions[k]), 1e-7);
    }
  }
}

TEST(ArmInverse, FindsEveryBranchOfReachablePosesInClosedForm) {
  for (std::uint64_t i = 0; i < num_poses(); ++i) {
    expect_all_branches(Arm(kModels[i % 3]), random_joints(i));
  }
}

// Solutions of a pose have the same branches: each of them is found again from any other.
TEST(ArmInverse, TheNumberOfBranchesIsThatOfTheGeometry) {
  std::array<int, 9> counts = {};
  const Arm arm(ArmModel::kUr3);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    ++counts.at(static_cast<std::size_t>(arm.inverse(arm.forward(random_joints(i))).size()));
  }
  EXPECT_EQ(counts[0] + counts[1] + counts[3] + counts[5] + counts[7], 0) << "elbows come in pairs";
  EXPECT_GT(counts[8], counts[4]);
}

// Of the poses nearer to singular ones than this, one in forty, some lie so far beyond the place
// where branches of the nominal arm meet that one of the two is not found.
constexpr double kHealthyMeasure = 0.001;

TEST(ArmInverse, RefinesEachBranchOnACalibratedArm) {
  std::uint64_t healthy = 0;
  std::uint64_t missed = 0;
  const std::uint64_t count = num_poses() / 4;
  for (std::uint64_t i = 0; i < count; ++i) {
    const ArmModel model = kModels[i % 3];
    const Arm arm(model, typical_deltas(model));
    const JointVector joints_rad = random_joints(i);
    const Eigen::Isometry3d pose = arm.forward(joints_rad);
    double nearest_rad = 10.0;
    for (const JointVector& solution_rad : arm.inverse(pose)) {
      const JointVector left = pose_difference(arm.forward(solution_rad), pose);
      EXPECT_LT(left.head<3>().norm(), 1e-9);
      EXPECT_LT(left.tail<3>().norm(), 1e-9);
      nearest_rad = std::min(nearest_rad, joint_distance_rad(solution_rad, joints_rad));
    }
    if (singularity_measure(arm.jacobian(joints_rad)) > kHealthyMeasure) {
      ++healthy;
      EXPECT_LT(nearest_rad, 1e-6) << joints_rad.transpose();
    }
    missed += nearest_rad < 1e-6 ? 0U : 1U;
  }
  EXPECT_GT(healthy, count - count / 25);
  EXPECT_LE(missed, 1 + count / 2000) << "of " << count;
}

TEST(ArmInverse, SolvesSingularPoses) {
  const Arm arm(ArmModel::kUr3e);
  for (std::uint64_t i = 0; i < 200; ++i) {
    for (const int joint : {2, 4}) {
      for (const double angle : {0.0, 1e-9, -1e-6, 1e-3}) {
        JointVector joints_rad = random_joints(i);
        joints_rad[joint] = angle;
        const Eigen::Isometry3d pose = arm.forward(joints_rad);
        const ArmSolutions solutions = arm.inverse(pose);
        ASSERT_FALSE(solutions.empty());
        for (const JointVector& solution_rad : solutions) {
          EXPECT_LT(pose_difference(arm.forward(solution_rad), pose).norm(), 1e-9);
        }
      }
    }
  }
}

TEST(ArmInverse, FindsNothingOutOfReach) {
  const Arm arm(ArmModel::kUr5e);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Eigen::Isometry3d pose = arm.forward(random_joints(i));
    pose.translation().x() += 2000.0;
    EXPECT_TRUE(arm.inverse(pose).empty());
  }
  Eigen::Isometry3d on_axis = Eigen::Isometry3d::Identity();
  on_axis.translation() = Eigen::Vector3d(0.0, 0.0, 500.0);
  EXPECT_TRUE(arm.inverse(on_axis).empty()) << "the wrist is nearer to the base's axis than d4";
}

TEST(NearestSolution, IsTheOneTheArmStandsIn) {
  const Arm arm(ArmModel::kUr3);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const JointVector joints_rad = 1.5 * random_joints(i);
    const auto nearest =
        nearest_solution(arm.inverse(arm.forward(joints_rad)), joints_rad, 2.0 * kPi);
    ASSERT_TRUE(nearest.has_value());
    EXPECT_LT((*nearest - joints_rad).cwiseAbs().maxCoeff(), 1e-6);
  }
}

}  // namespace
}  // namespace glint
