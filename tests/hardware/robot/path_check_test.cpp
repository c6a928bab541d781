// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/path_check.h"

#include <algorithm>
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

// So many steps of 2 mm from there that an int does not hold their number: no way is too long to be
// looked at.
TEST(CheckJointMotion, RefusesAStartFarBeyondTheJointsLimits) {
  for (const double turn_deg : {400.0, 1e10, 1e300, -1e10}) {
    const CheckedMotion motion =
        check_joint_motion(test_arm(), turned(5, turn_deg), test_start_rad(), 1.0);
    EXPECT_EQ(motion.problem, Problem::kJointLimit) << turn_deg;
    EXPECT_THAT(motion.text, testing::StartsWith("joint 6 at "));
  }
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

/// An upright arm whose elbow is bent by so much, to +x where that is negative. From one side to
/// the other the elbow alone goes along x; wrist and tool go up and down by some millimetres.
JointVector bent_rad(double bend_rad) {
  const DhTable table = nominal_table(ArmModel::kUr3e);
  const double upper_mm = std::abs(table[1].a_mm);
  const double forearm_mm = std::abs(table[2].a_mm);
  const double both_mm = upper_mm + forearm_mm;
  return JointVector{0.0, -90.0, 0.0, -90.0, -90.0, 0.0} * kRadPerDeg +
         bend_rad * JointVector{0.0, forearm_mm / both_mm, -1.0, upper_mm / both_mm, 0.0, 0.0};
}

constexpr double kBendRad = 0.2;

ArmShape shape_of(const ArmWithTool& arm, const JointVector& joints_rad) {
  return arm_shape(arm.arm, joints_rad, arm.flange_from_tcp, arm.tool_radius_mm);
}

TEST(CheckJointMotion, NamesTheElbowThatAloneLeavesTheBox) {
  MotionLimits limits = test_limits();
  limits.box_max_mm[0] = 75.0;
  const ArmWithTool arm = test_arm(limits);
  ASSERT_EQ(outside_box(arm, bent_rad(kBendRad), 0.0), "");
  int outside = 0;
  for (const Capsule& link : shape_of(arm, bent_rad(-kBendRad))) {
    outside += std::max(link.from_mm.x(), link.to_mm.x()) + link.radius_mm > 75.0 ? 1 : 0;
  }
  ASSERT_EQ(outside, 1) << "the tool and all links but one stay within";
  const CheckedMotion motion =
      check_joint_motion(arm, bent_rad(kBendRad), bent_rad(-kBendRad), 1.0);
  EXPECT_EQ(motion.problem, Problem::kBox);
  EXPECT_THAT(motion.text, testing::HasSubstr("the upper arm is"));
  EXPECT_THAT(motion.text, testing::HasSubstr("outside the box along x"));
}

/// The link whose end is the fastest in the middle of the motion, and speeds of all, mm/s.
struct LinkSpeeds {
  std::array<double, kLinkNames.size()> mm_s = {};

  LinkSpeeds(const ArmWithTool& arm, double leading_rad_s) {
    constexpr double kStepRad = 1e-4;
    const ArmShape from = shape_of(arm, bent_rad(kStepRad));
    const ArmShape to = shape_of(arm, bent_rad(-kStepRad));
    for (std::size_t i = 0; i < mm_s.size(); ++i) {
      mm_s[i] = (to[i].to_mm - from[i].to_mm).norm() / (2.0 * kStepRad) * leading_rad_s;
    }
  }

  std::string_view fastest() const {
    return kLinkNames[static_cast<std::size_t>(std::ranges::max_element(mm_s) - mm_s.begin())];
  }
};

// The tip hardly moves: a check of the tip alone would let the joints turn at their own limit.
TEST(CheckJointMotion, SlowsDownForAnElbowThatAloneWouldBeTooFast) {
  MotionLimits limits = test_limits();
  limits.tool_speed_mm_s = 100.0;
  const ArmWithTool arm = test_arm(limits);
  const CheckedMotion motion =
      check_joint_motion(arm, bent_rad(kBendRad), bent_rad(-kBendRad), 1.0);
  ASSERT_TRUE(motion.is_allowed()) << motion.text;
  EXPECT_LT(motion.speed, 0.9 * limits.joint_speed_rad_s);
  const LinkSpeeds speeds(arm, motion.speed);
  EXPECT_EQ(speeds.fastest(), "upper arm");
  const double turn_rad_s = (bent_rad(motion.speed) - bent_rad(0.0))[1];
  const double outside_mm_s = shape_of(arm, bent_rad(0.0))[1].radius_mm * turn_rad_s;
  EXPECT_NEAR(speeds.mm_s[1] + outside_mm_s, limits.tool_speed_mm_s / kToolSpeedReserve, 0.5);
  EXPECT_LT(speeds.mm_s.back(), 0.3 * limits.tool_speed_mm_s);
}

// The axes of wrist 3 and of the tool stand still; what is around them goes round.
TEST(CheckJointMotion, SlowsDownForTheRimOfAToolThatTurnsAboutItsOwnAxis) {
  UrSettings robot = test_robot(ArmModel::kUr3e);
  robot.tool_radius_mm = 90.0;
  MotionLimits limits = test_limits();
  limits.tool_speed_mm_s = 100.0;
  limits.joint_speed_rad_s = kPi;
  const ArmWithTool arm = arm_with_tool(robot, limits);
  const CheckedMotion motion = check_joint_motion(arm, test_start_rad(), turned(5, 90), 1.0);
  ASSERT_TRUE(motion.is_allowed()) << motion.text;
  EXPECT_NEAR(motion.speed * robot.tool_radius_mm, 100.0 / kToolSpeedReserve, 0.01);
}

// The tip goes on a line and the tool turns about its axis: the rim is faster than the tip.
TEST(CheckLineMotion, SlowsDownForTheRimOfAToolThatTurns) {
  UrSettings robot = test_robot(ArmModel::kUr3e);
  robot.tool_radius_mm = 90.0;
  const ArmWithTool arm = arm_with_tool(robot, test_limits());
  Eigen::Isometry3d goal = arm.base_from_tcp(test_start_rad());
  constexpr double kTurnRad = 0.05;
  goal.translation().z() += 1000.0 * kTurnRad;
  goal.rotate(Eigen::AngleAxisd(kTurnRad, Eigen::Vector3d::UnitZ()));
  const CheckedMotion motion = check_line_motion(arm, test_start_rad(), goal, 1.0);
  ASSERT_TRUE(motion.is_allowed()) << motion.text;
  const double rim_mm_s = motion.speed * (1.0 + 0.001 * robot.tool_radius_mm);
  EXPECT_LE(rim_mm_s, 1.001 * test_limits().tool_speed_mm_s / kToolSpeedReserve);
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
  double t = 0.0;
  while (t < leading.duration_s()) {
    const ArmShape now = shape(t);
    const ArmShape next = shape(t + 0.001);
    for (std::size_t i = 0; i < now.size(); ++i) {
      fastest = std::max(fastest, (next[i].to_mm - now[i].to_mm).norm() / 0.001);
    }
    t += 0.01;
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
