// SPDX-License-Identifier: GPL-3.0-or-later
//
// Motions are looked at along their whole path before anything is sent: joints within +- 2 pi,
// every link and the tool within the box, every speed within its limit, lines clear of singular
// poses.
//
// The path is sampled so densely that no point of the arm moves by more than 2 mm between two
// samples; capsules are taken 1 mm thicker, which covers what lies between.
#pragma once

#include <string>

#include "hardware/robot/ur_settings.h"

namespace glint {

/// A motion that was checked, or why it must not be made.
struct CheckedMotion {
  enum class Kind { kJoints, kLine };
  enum class Problem { kNone, kJointLimit, kBox, kUnreachable, kSingular };

  Kind kind = Kind::kJoints;
  Problem problem = Problem::kNone;
  std::string text;  ///< of the problem: which link, by how much
  JointVector start_rad = JointVector::Zero();
  JointVector goal_rad = JointVector::Zero();
  Eigen::Isometry3d base_from_tcp = Eigen::Isometry3d::Identity();  ///< of the goal, mm
  double speed = 0.0;         ///< rad/s of the leading joint, or mm/s of the tip
  double acceleration = 0.0;  ///< rad/s2, or mm/s2
  double duration_s = 0.0;    ///< at full speed scaling

  bool is_allowed() const { return problem == Problem::kNone; }
};

inline constexpr double kJointLimitRad = 6.283185307179586;

/// No point of a link or of the tool, their radii counted, is planned to be faster than
/// limits.tool_speed_mm_s divided by this. Controllers overshoot a little, and a tool that is
/// faster than the limit itself is stopped.
inline constexpr double kToolSpeedReserve = 1.1;

/// movej. The leading joint's speed is share of its limit, less where a link or the tool would be
/// too fast.
/// @param share  of the limits of speed, in (0, 1]
CheckedMotion check_joint_motion(const ArmWithTool& arm,
                                 const JointVector& start_rad,
                                 const JointVector& goal_rad,
                                 double share);

/// movel: the tip on a straight line, the rotation about one axis at the same pace.
CheckedMotion check_line_motion(const ArmWithTool& arm,
                                const JointVector& start_rad,
                                const Eigen::Isometry3d& base_from_tcp,
                                double share);

/// The first link that leaves the box at these joints and how far; empty: none.
std::string outside_box(const ArmWithTool& arm, const JointVector& joints_rad, double margin_mm);

/// Pose on the line between two others. @param share  of the way, 0 to 1
Eigen::Isometry3d pose_between(const Eigen::Isometry3d& from,
                               const Eigen::Isometry3d& to,
                               double share);

/// What a line's speed counts along: millimetres, or for turns 1000 mm to a radian where that is
/// more.
double line_length_mm(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

}  // namespace glint
