// SPDX-License-Identifier: GPL-3.0-or-later
//
// The room that an arm takes: each link as a capsule, a segment with a radius.
#pragma once

#include <array>

#include "hardware/robot/kinematics/arm.h"

namespace glint {

/// A segment in the base frame and everything nearer to it than the radius.
struct Capsule {
  Eigen::Vector3d from_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d to_mm = Eigen::Vector3d::Zero();
  double radius_mm = 0.0;
};

/// What moves: shoulder, upper arm, elbow, forearm, three links of the wrist, tool.
inline constexpr std::array<std::string_view, 8> kLinkNames = {
    "shoulder", "upper arm", "elbow", "forearm", "wrist 1", "wrist 2", "wrist 3", "tool"};

using ArmShape = std::array<Capsule, kLinkNames.size()>;

/// The links at a pose of the joints. Upper arm and forearm run beside the axes of the table, by
/// their maker's drawings; radii are those of the joints' housings, rounded up.
/// @param flange_from_tcp  mm: the tool is the segment from the flange to its tip
ArmShape arm_shape(const Arm& arm,
                   const JointVector& joints_rad,
                   const Eigen::Isometry3d& flange_from_tcp,
                   double tool_radius_mm);

/// The links at a pose of the joints and the frames that they turn with.
struct PosedArm {
  LinkFrames frames;
  ArmShape shape;
};

PosedArm posed_arm(const Arm& arm,
                   const JointVector& joints_rad,
                   const Eigen::Isometry3d& flange_from_tcp,
                   double tool_radius_mm);

/// How far the end of any link's axis moves between two poses.
double largest_end_motion_mm(const ArmShape& a, const ArmShape& b);

/// How far any point of the arm or of its tool moves between two poses near each other, at most: a
/// link's outside moves by its radius times the angle that the link turns through farther than its
/// axis does.
double largest_motion_mm(const PosedArm& a, const PosedArm& b);

/// No point of the arm or of its tool is farther from the base's origin than this, mm.
double farthest_reach_mm(const Arm& arm,
                         const Eigen::Isometry3d& flange_from_tcp,
                         double tool_radius_mm);

}  // namespace glint
