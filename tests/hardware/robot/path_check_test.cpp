// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/path_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/SVD>

#include "core/rng.h"
#include "core/units.h"
#include "hardware/robot/kinematics/link_shapes.h"
#include "hardware/robot/trapezoid.h"
#include "tests/hardware/robot/cell_robot_settings.h"

namespace glint {
namespace {

using Problem = CheckedMotion::Problem;

ArmWithTool test_arm(const MotionLimits& limits = test_limits()) {
  return arm_with_tool(test_robot(ArmModel::kUr3e), limits);
}

JointVector turned(int joint, double angle_deg) {
  JointVector joints_rad = test_start_rad();
  joints_rad[joint] += angle_deg * kRadPerDeg;
  return joints_rad;
}

TEST(CheckJointMotion, AllowsWhatStaysWithinTheLimits) {
  const CheckedMotion motion = check_joint_motion(test_arm(), test_start_rad(), turned(0, 60), 1.0);
  ASSERT_TRUE(motion.is_allowed()) << motion.text;
  EXPECT_GT(motion.speed, 0.0);
  EXPECT_LE(motion.speed, test_limits().joint_speed_rad_s);
  EXPECT_GT(motion.duration_s, 1.0);
}

// Joint 1 alone: the tip moves on a circle about the base's axis, so its speed is radius times
// speed.
TEST(CheckJointMotion, SlowsDownForTheTip) {
  const ArmWithTool arm = test_arm();
  const CheckedMotion motion = check_joint_motion(arm, test_start_rad(), turned(0, 60), 1.0);
  const Eigen::Vector3d tip_mm = arm.base_from_tcp(test_start_rad()).translation();
  const double tip_mm_s = tip_mm.head<2>().norm() * motion.speed;
  EXPECT_LE(tip_mm_s, arm.limits.tool_speed_mm_s);
  const CheckedMotion half = check_joint_motion(arm, test_start_rad(), turned(0, 60), 0.5);
  EXPECT_NEAR(half.speed, 0.5 * motion.speed, 1e-12);
}

TEST(CheckJointMotion, RefusesWhereALinkLeavesTheBoxOnTheWay) {
  MotionLimits limits = test_limits();
  // The tip's circle about the base's axis passes +y; start and goal lie within.
  const Eigen::Vector3d tip_mm = test_arm().base_from_tcp(test_start_rad()).translation();
  JointVector left = test_start_rad();
  JointVector right = test_start_rad();
  left[0] += kPi / 2.0 - std::atan2(tip_mm.y(), tip_mm.x()) + 50.0 * kRadPerDeg;
  right[0] += kPi / 2.0 - std::atan2(tip_mm.y(), tip_mm.x()) - 50.0 * kRadPerDeg;
  limits.box_max_mm[1] = 0.9 * tip_mm.head<2>().norm() + 40.0;
  const ArmWithTool arm = test_arm(limits);
  ASSERT_EQ(outside_box(arm, left, 0.0), "");
  ASSERT_EQ(outside_box(arm, right, 0.0), "");
  const CheckedMotion motion = check_joint_motion(arm, left, right, 1.0);
  EXPECT_EQ(motion.problem, Problem::kBox);
  EXPECT_THAT(motion.text, testing::HasSubstr("outside the box along y"));
}

/// A small motion of joints 2 to 4, which lie in one plane, that leaves the tip where it is to the
/// first order: the elbow rises.
JointVector elbow_only(const ArmWithTool& arm, double turn_rad) {
  constexpr double kStepRad = 1e-6;
  Eigen::Matrix3d tip_by_joint;
  for (int i = 0; i < 3; ++i) {
    JointVector step_rad = JointVector::Zero();
    step_rad[i + 1] = kStepRad;
    tip_by_joint.col(i) = (arm.base_from_tcp(test_start_rad() + step_rad).translation() -
                           arm.base_from_tcp(test_start_rad() - step_rad).translation()) /
                          (2.0 * kStepRad);
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(tip_by_joint, Eigen::ComputeFullV);
  Eigen::Vector3d way = svd.matrixV().col(2);
  way *= (way[0] > 0.0 ? -1.0 : 1.0) * turn_rad / way.cwiseAbs().maxCoeff();  // joint 2 backwards
  JointVector way_rad = JointVector::Zero();
  way_rad.segment<3>(1) = way;
  return way_rad;
}

ArmShape shape_of(const ArmWithTool& arm, const JointVector& joints_rad) {
  return arm_shape(arm.arm, joints_rad, arm.flange_from_tcp, arm.tool_radius_mm);
}

constexpr std::size_t kUpperArm = 1;
constexpr std::size_t kTool = kLinkNames.size() - 1;

TEST(CheckJointMotion, NamesTheElbowThatAloneLeavesTheBox) {
  const JointVector goal_rad = test_start_rad() + elbow_only(test_arm(), 0.2);
  const Capsule before = shape_of(test_arm(), test_start_rad())[kUpperArm];
  const Capsule after = shape_of(test_arm(), goal_rad)[kUpperArm];
  ASSERT_LT(after.to_mm.x(), before.to_mm.x() - 10.0) << "the elbow goes backwards";
  MotionLimits limits = test_limits();
  limits.box_min_mm[0] = 0.5 * (before.to_mm.x() + after.to_mm.x()) - before.radius_mm;
  const ArmWithTool arm = test_arm(limits);
  ASSERT_EQ(outside_box(arm, test_start_rad(), 0.0), "");
  const Capsule tool = shape_of(arm, goal_rad)[kTool];
  ASSERT_GT(std::min(tool.from_mm.x(), tool.to_mm.x()) - tool.radius_mm, limits.box_min_mm[0])
      << "the tool stays within";
  const CheckedMotion motion = check_joint_motion(arm, test_start_rad(), goal_rad, 1.0);
  EXPECT_EQ(motion.problem, Problem::kBox);
  EXPECT_THAT(motion.text, testing::HasSubstr("the upper arm is"));
  EXPECT_THAT(motion.text, testing::HasSubstr("outside the box along x"));
}

/// The number of the link whose end goes farthest in a motion's first thousandth.
std::size_t fastest_link(const ArmWithTool& arm, const JointVector& way_rad) {
  const ArmShape from = shape_of(arm, test_start_rad());
  const ArmShape to = shape_of(arm, test_start_rad() + 1e-3 * way_rad);
  std::size_t fastest = 0;
  for (std::size_t i = 1; i < from.size(); ++i) {
    const auto way_mm = [&](std::size_t link) {
      return (to[link].to_mm - from[link].to_mm).norm();
    };
    fastest = way_mm(i) > way_mm(fastest) + 1e-9 ? i : fastest;
  }
  return fastest;
}

// The tip hardly moves: a check of the tip alone would let the joints turn at their own limit.
TEST(CheckJointMotion, SlowsDownForAnElbowThatAloneWouldBeTooFast) {
  MotionLimits limits = test_limits();
  limits.tool_speed_mm_s = 100.0;
  const ArmWithTool arm = test_arm(limits);
  const JointVector way_rad = elbow_only(arm, 0.2);
  EXPECT_EQ(kLinkNames[fastest_link(arm, way_rad)], "upper arm");
  const CheckedMotion motion =
      check_joint_motion(arm, test_start_rad(), test_start_rad() + way_rad, 1.0);
  ASSERT_TRUE(motion.is_allowed()) << motion.text;
  const auto speed_mm_s = [&](std::size_t link) {
    const ArmShape from = shape_of(arm, test_start_rad());
    const ArmShape to = shape_of(arm, test_start_rad() + 1e-3 * way_rad);
    const double turn_rad = 1e-3 * way_rad.cwiseAbs().maxCoeff();
    return (to[link].to_mm - from[link].to_mm).norm() / turn_rad * motion.speed;
  };
  EXPECT_LT(motion.speed, 0.9 * limits.joint_speed_rad_s);
  EXPECT_LE(speed_mm_s(kUpperArm), limits.tool_speed_mm_s / kToolSpeedReserve + 1e-6);
  EXPECT_GT(speed_mm_s(kUpperArm), 0.9 * limits.tool_speed_mm_s / kToolSpeedReserve);
  EXPECT_LT(speed_mm_s(kTool), 0.1 * limits.tool_speed_mm_s);
}

TEST(CheckJointMotion, RefusesJointsBeyondTheirLimitAndNumbersThatAreNone) {
  const ArmWithTool arm = test_arm();
  EXPECT_EQ(check_joint_motion(arm, test_start_rad(), turned(5, 361), 1.0).problem,
            Problem::kJointLimit);
  JointVector none = test_start_rad();
  none[2] = std::nan("");
  EXPECT_EQ(check_joint_motion(arm, test_start_rad(), none, 1.0).problem, Problem::kJointLimit);
}

TEST(CheckLineMotion, KeepsTheTipOnTheLineAndItsSpeed) {
  const ArmWithTool arm = test_arm();
  Eigen::Isometry3d goal = arm.base_from_tcp(test_start_rad());
  goal.translation().z() += 60.0;
  const CheckedMotion motion = check_line_motion(arm, test_start_rad(), goal, 1.0);
  ASSERT_TRUE(motion.is_allowed()) << motion.text;
  EXPECT_LE(motion.speed, arm.limits.tool_speed_mm_s);
  EXPECT_LT(pose_difference(arm.base_from_tcp(motion.goal_rad), goal).norm(), 1e-6);
}

TEST(CheckLineMotion, RefusesWhatIsOutOfReachOrSingular) {
  const ArmWithTool arm = test_arm();
  Eigen::Isometry3d far = arm.base_from_tcp(test_start_rad());
  far.translation().x() *= 4.0;
  const CheckedMotion away = check_line_motion(arm, test_start_rad(), far, 1.0);
  EXPECT_TRUE(away.problem == Problem::kUnreachable || away.problem == Problem::kSingular);
  JointVector wrist = test_start_rad();
  wrist[4] = 1e-3;
  Eigen::Isometry3d goal = arm.base_from_tcp(wrist);
  goal.translation().z() += 10.0;
  EXPECT_EQ(check_line_motion(arm, wrist, goal, 1.0).problem, Problem::kSingular);
}

/// The fastest point of the arm along a checked motion, in steps of 1 ms.
double fastest_link_mm_s(const ArmWithTool& arm, const CheckedMotion& motion) {
  const JointVector way_rad = motion.goal_rad - motion.start_rad;
  const double length = way_rad.cwiseAbs().maxCoeff();
  const Trapezoid leading(length, motion.speed, motion.acceleration);
  const auto shape = [&](double t) {
    return arm_shape(arm.arm,
                     motion.start_rad + way_rad * (leading.at(t) / length),
                     arm.flange_from_tcp,
                     arm.tool_radius_mm);
  };
  double fastest = 0.0;
  for (double t = 0.0; t < leading.duration_s(); t += 0.01) {
    const ArmShape now = shape(t);
    const ArmShape next = shape(t + 0.001);
    for (std::size_t i = 0; i < now.size(); ++i) {
      fastest = std::max(fastest, (next[i].to_mm - now[i].to_mm).norm() / 0.001);
    }
  }
  return fastest;
}

TEST(CheckJointMotion, NoLinkIsEverFasterThanAllowed) {
  const ArmWithTool arm = test_arm();
  int allowed = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    Rng rng(11, Stream::kTest, i);
    JointVector goal_rad = test_start_rad();
    for (double& angle : goal_rad) {
      angle += rng.uniform(-0.6, 0.6);
    }
    const CheckedMotion motion = check_joint_motion(arm, test_start_rad(), goal_rad, 1.0);
    if (motion.is_allowed()) {
      ++allowed;
      EXPECT_LE(kToolSpeedReserve * fastest_link_mm_s(arm, motion),
                1.02 * arm.limits.tool_speed_mm_s)
          << "between samples links may be a little faster";
    }
  }
  EXPECT_GT(allowed, 30);
}

}  // namespace
}  // namespace glint
