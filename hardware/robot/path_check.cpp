// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/path_check.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/units.h"
#include "hardware/robot/kinematics/link_shapes.h"
#include "hardware/robot/trapezoid.h"

namespace glint {
namespace {

constexpr double kStepMm = 2.0;
constexpr double kBetweenMm =
    0.5 * kStepMm;                          ///< how far a path bulges between two samples, at most
constexpr double kJointSpeedMargin = 1.02;  ///< between samples joints may be a little faster
constexpr double kMmPerRad = 1000.0;

PosedArm posed(const ArmWithTool& arm, const JointVector& joints_rad) {
  return posed_arm(arm.arm, joints_rad, arm.flange_from_tcp, arm.tool_radius_mm);
}

/// So many steps that no point of the arm moves farther than kStepMm in one.
int joint_steps(const ArmWithTool& arm, const JointVector& motion_rad) {
  const double reach_mm = farthest_reach_mm(arm.arm, arm.flange_from_tcp, arm.tool_radius_mm);
  return 1 + static_cast<int>(reach_mm * motion_rad.cwiseAbs().sum() / kStepMm);
}

void refuse(CheckedMotion& motion, CheckedMotion::Problem problem, std::string text) {
  motion.problem = problem;
  motion.text = std::move(text);
}

/// A joint beyond its limit; empty: none.
std::string beyond_limit(const JointVector& joints_rad) {
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!(std::abs(joints_rad[i]) <= kJointLimitRad)) {
      return fmt::format(
          "joint {} at {:.1f} degrees, the limit is 360", i + 1, joints_rad[i] * kDegPerRad);
    }
  }
  return {};
}

bool passes_limits(const ArmWithTool& arm, const JointVector& joints_rad, CheckedMotion& motion) {
  if (std::string text = beyond_limit(joints_rad); !text.empty()) {
    refuse(motion, CheckedMotion::Problem::kJointLimit, std::move(text));
    return false;
  }
  if (std::string text = outside_box(arm, joints_rad, kBetweenMm); !text.empty()) {
    refuse(motion, CheckedMotion::Problem::kBox, std::move(text));
    return false;
  }
  return true;
}

/// The next joints of a line: the branch goes on, or there is none.
std::optional<JointVector> next_on_line(const ArmWithTool& arm,
                                        const Eigen::Isometry3d& base_from_tcp,
                                        const JointVector& before_rad) {
  const Eigen::Isometry3d base_from_flange = base_from_tcp * arm.flange_from_tcp.inverse();
  if (const auto joints_rad = arm.arm.refined(base_from_flange, before_rad)) {
    return nearest_turns(*joints_rad, before_rad, 2.0 * kJointLimitRad);
  }
  return std::nullopt;
}

/// Walks along a line and keeps what its speed is limited by.
struct LineWalk {
  double joint_rad_per_mm = 0.0;
  double link_mm_per_mm = 1.0;
  JointVector joints_rad;
  PosedArm before;
};

bool take_step(const ArmWithTool& arm,
               const Eigen::Isometry3d& base_from_tcp,
               double step_mm,
               LineWalk& walk,
               CheckedMotion& motion) {
  const auto joints_rad = next_on_line(arm, base_from_tcp, walk.joints_rad);
  const double measure = joints_rad ? singularity_measure(arm.arm.jacobian(*joints_rad)) : 0.0;
  const double turn_rad = joints_rad ? (*joints_rad - walk.joints_rad).cwiseAbs().maxCoeff() : 0.0;
  if (!joints_rad) {
    refuse(motion, CheckedMotion::Problem::kUnreachable, "the line leaves the arm's reach");
    return false;
  }
  const PosedArm now = posed(arm, *joints_rad);
  const bool jumps = largest_end_motion_mm(now.shape, walk.before.shape) > kStepMm;
  if (measure < arm.limits.min_singularity_measure || jumps) {
    refuse(motion,
           CheckedMotion::Problem::kSingular,
           fmt::format("the line passes a singular pose: measure {:.4f}, allowed is {:.4f}",
                       measure,
                       arm.limits.min_singularity_measure));
    return false;
  }
  if (!passes_limits(arm, *joints_rad, motion)) {
    return false;
  }
  walk.joint_rad_per_mm = std::max(walk.joint_rad_per_mm, turn_rad / step_mm);
  walk.link_mm_per_mm =
      std::max(walk.link_mm_per_mm, largest_motion_mm(now, walk.before) / step_mm);
  walk.joints_rad = *joints_rad;
  walk.before = now;
  return true;
}

/// Goes along a motion of the joints. @return how far a point of the arm goes for each radian of
/// the leading joint; none where the motion is refused
std::optional<double> walk_joints(const ArmWithTool& arm,
                                  const JointVector& way_rad,
                                  CheckedMotion& motion) {
  const double leading_rad = way_rad.cwiseAbs().maxCoeff();
  const int steps = joint_steps(arm, way_rad);
  PosedArm before = posed(arm, motion.start_rad);
  double link_mm_per_rad = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const JointVector joints_rad = motion.start_rad + way_rad * (static_cast<double>(i) / steps);
    if (!passes_limits(arm, joints_rad, motion)) {
      return std::nullopt;
    }
    const PosedArm now = posed(arm, joints_rad);
    if (i > 0 && leading_rad > 0.0) {
      link_mm_per_rad =
          std::max(link_mm_per_rad, largest_motion_mm(now, before) * steps / leading_rad);
    }
    before = now;
  }
  return link_mm_per_rad;
}

}  // namespace

std::string outside_box(const ArmWithTool& arm, const JointVector& joints_rad, double margin_mm) {
  const ArmShape shape = arm_shape(arm.arm, joints_rad, arm.flange_from_tcp, arm.tool_radius_mm);
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const double radius_mm = shape[i].radius_mm + margin_mm;
    const Eigen::Vector3d low_mm = shape[i].from_mm.cwiseMin(shape[i].to_mm);
    const Eigen::Vector3d high_mm = shape[i].from_mm.cwiseMax(shape[i].to_mm);
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const double beyond_mm = std::max(arm.limits.box_min_mm[axis] - (low_mm[k] - radius_mm),
                                        high_mm[k] + radius_mm - arm.limits.box_max_mm[axis]);
      if (!(beyond_mm <= 0.0)) {
        return fmt::format(
            "the {} is {:.1f} mm outside the box along {}", kLinkNames[i], beyond_mm, "xyz"[k]);
      }
    }
  }
  return {};
}

CheckedMotion check_joint_motion(const ArmWithTool& arm,
                                 const JointVector& start_rad,
                                 const JointVector& goal_rad,
                                 double share) {
  CheckedMotion motion = {.start_rad = start_rad,
                          .goal_rad = goal_rad,
                          .base_from_tcp = arm.base_from_tcp(goal_rad),
                          .acceleration = arm.limits.joint_acceleration_rad_s2};
  for (const JointVector& end_rad : {start_rad, goal_rad}) {  // before its steps are counted
    if (std::string text = beyond_limit(end_rad); !text.empty()) {
      refuse(motion, CheckedMotion::Problem::kJointLimit, std::move(text));
      return motion;
    }
  }
  const JointVector way_rad = goal_rad - start_rad;
  const double leading_rad = way_rad.cwiseAbs().maxCoeff();
  const auto link_mm_per_rad = walk_joints(arm, way_rad, motion);
  if (!link_mm_per_rad) {
    return motion;
  }
  motion.speed = share * arm.limits.joint_speed_rad_s;
  if (*link_mm_per_rad > 0.0) {
    motion.speed = std::min(
        motion.speed, share * arm.limits.tool_speed_mm_s / (kToolSpeedReserve * *link_mm_per_rad));
  }
  motion.duration_s = Trapezoid(leading_rad, motion.speed, motion.acceleration).duration_s();
  return motion;
}

CheckedMotion check_line_motion(const ArmWithTool& arm,
                                const JointVector& start_rad,
                                const Eigen::Isometry3d& base_from_tcp,
                                double share) {
  CheckedMotion motion = {.kind = CheckedMotion::Kind::kLine,
                          .start_rad = start_rad,
                          .base_from_tcp = base_from_tcp,
                          .acceleration = arm.limits.tool_acceleration_mm_s2};
  const Eigen::Isometry3d from = arm.base_from_tcp(start_rad);
  const double length_mm = line_length_mm(from, base_from_tcp);
  // Steps of 1 mm, or 1 mrad: joints then turn little enough for Newton's method to stay on a
  // branch.
  const int steps = 1 + static_cast<int>(length_mm);
  const double step_mm = std::max(length_mm / steps, 1e-9);
  LineWalk walk = {.joints_rad = start_rad, .before = posed(arm, start_rad)};
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Isometry3d pose =
        pose_between(from, base_from_tcp, static_cast<double>(i) / steps);
    if (!take_step(arm, pose, step_mm, walk, motion)) {
      return motion;
    }
  }
  motion.goal_rad = walk.joints_rad;
  motion.speed = share * arm.limits.tool_speed_mm_s / (kToolSpeedReserve * walk.link_mm_per_mm);
  if (walk.joint_rad_per_mm > 0.0) {
    motion.speed = std::min(
        motion.speed,
        share * arm.limits.joint_speed_rad_s / (kJointSpeedMargin * walk.joint_rad_per_mm));
  }
  motion.duration_s = Trapezoid(length_mm, motion.speed, motion.acceleration).duration_s();
  return motion;
}

Eigen::Isometry3d pose_between(const Eigen::Isometry3d& from,
                               const Eigen::Isometry3d& to,
                               double share) {
  const JointVector way = pose_difference(to, from);
  Eigen::Isometry3d pose;
  pose.matrix().setIdentity();
  pose.translation() = from.translation() + share * way.head<3>();
  const double angle_rad = way.tail<3>().norm();
  pose.linear() = from.linear();
  if (angle_rad > 0.0) {
    pose.linear() = Eigen::AngleAxisd(share * angle_rad, way.tail<3>() / angle_rad) * from.linear();
  }
  return pose;
}

double line_length_mm(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  const JointVector way = pose_difference(to, from);
  return std::max(way.head<3>().norm(), kMmPerRad * way.tail<3>().norm());
}

}  // namespace glint
