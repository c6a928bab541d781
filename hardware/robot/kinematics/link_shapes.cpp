// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/kinematics/link_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace glint {
namespace {

struct LinkSizes {
  double
      upper_arm_mm;   ///< how far the upper arm is from the base's axis, along the shoulder's axis
  double forearm_mm;  ///< the same of the forearm
  double arm_radius_mm;
  double forearm_radius_mm;
  double wrist_radius_mm;
};

constexpr std::array<LinkSizes, 3> kSizes = {{
    {120.0, 27.0, 60.0, 50.0, 45.0},
    {120.0, 27.0, 60.0, 50.0, 45.0},
    {138.0, 7.0, 80.0, 65.0, 55.0},
}};

/// Which links each capsule turns with: those along the axis of a joint hold its housing, one half
/// of which turns with the link before it and one with the link behind it.
constexpr std::array<std::pair<std::size_t, std::size_t>, kLinkNames.size()> kTurnsWith = {
    {{1, 2}, {2, 2}, {2, 3}, {3, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 6}}};

double turn_rad(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle();
}

}  // namespace

ArmShape arm_shape(const Arm& arm,
                   const JointVector& joints_rad,
                   const Eigen::Isometry3d& flange_from_tcp,
                   double tool_radius_mm) {
  const LinkSizes& sizes = kSizes.at(static_cast<std::size_t>(arm.model()));
  const LinkFrames frames = arm.frames(joints_rad);
  const Eigen::Vector3d axis = frames[1].linear().col(2);  // of joints 2 to 4
  const Eigen::Vector3d shoulder_mm = frames[1].translation();
  const Eigen::Vector3d upper_mm = shoulder_mm + sizes.upper_arm_mm * axis;
  // With deltas frames 2 and 3 may lie anywhere along the axes of their joints: back to the plane.
  const auto in_plane = [&](const Eigen::Vector3d& point_mm, double offset_mm) {
    return Eigen::Vector3d(point_mm + (offset_mm - axis.dot(point_mm - shoulder_mm)) * axis);
  };
  const Eigen::Vector3d elbow_mm = in_plane(frames[2].translation(), sizes.upper_arm_mm);
  const Eigen::Vector3d inner_elbow_mm = in_plane(elbow_mm, sizes.forearm_mm);
  const Eigen::Vector3d wrist1_mm = in_plane(frames[3].translation(), sizes.forearm_mm);
  const Eigen::Vector3d wrist2_mm = frames[4].translation();
  const Eigen::Vector3d wrist3_mm = frames[5].translation();
  const Eigen::Vector3d flange_mm = frames[6].translation();
  const Eigen::Vector3d tip_mm = frames[6] * flange_from_tcp.translation();
  return {{{shoulder_mm, upper_mm, sizes.arm_radius_mm},
           {upper_mm, elbow_mm, sizes.arm_radius_mm},
           {elbow_mm, inner_elbow_mm, sizes.forearm_radius_mm},
           {inner_elbow_mm, wrist1_mm, sizes.forearm_radius_mm},
           {wrist1_mm, wrist2_mm, sizes.wrist_radius_mm},
           {wrist2_mm, wrist3_mm, sizes.wrist_radius_mm},
           {wrist3_mm, flange_mm, sizes.wrist_radius_mm},
           {flange_mm, tip_mm, tool_radius_mm}}};
}

PosedArm posed_arm(const Arm& arm,
                   const JointVector& joints_rad,
                   const Eigen::Isometry3d& flange_from_tcp,
                   double tool_radius_mm) {
  return {.frames = arm.frames(joints_rad),
          .shape = arm_shape(arm, joints_rad, flange_from_tcp, tool_radius_mm)};
}

double largest_end_motion_mm(const ArmShape& a, const ArmShape& b) {
  double motion_mm = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    motion_mm = std::max(motion_mm, (a[i].to_mm - b[i].to_mm).norm());
  }
  return motion_mm;
}

double largest_motion_mm(const PosedArm& a, const PosedArm& b) {
  std::array<double, std::tuple_size_v<LinkFrames>> turns_rad = {};
  for (std::size_t link = 1; link < turns_rad.size(); ++link) {
    turns_rad[link] = turn_rad(a.frames[link], b.frames[link]);
  }
  double motion_mm = 0.0;
  for (std::size_t i = 0; i < a.shape.size(); ++i) {
    const double axis_mm = std::max((a.shape[i].from_mm - b.shape[i].from_mm).norm(),
                                    (a.shape[i].to_mm - b.shape[i].to_mm).norm());
    const auto [first, last] = kTurnsWith[i];
    const double turned_rad = std::max(turns_rad[first], turns_rad[last]);
    motion_mm = std::max(motion_mm, axis_mm + a.shape[i].radius_mm * turned_rad);
  }
  return motion_mm;
}

double farthest_reach_mm(const Arm& arm,
                         const Eigen::Isometry3d& flange_from_tcp,
                         double tool_radius_mm) {
  const LinkSizes& sizes = kSizes.at(static_cast<std::size_t>(arm.model()));
  double reach_mm = sizes.upper_arm_mm + sizes.arm_radius_mm;
  for (const DhRow& row : nominal_table(arm.model())) {
    reach_mm += std::abs(row.a_mm) + std::abs(row.d_mm);
  }
  return reach_mm + flange_from_tcp.translation().norm() + tool_radius_mm;
}

}  // namespace glint
