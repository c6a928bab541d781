// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/leg_map.h"

#include <algorithm>
#include <limits>

#include "hardware/robot/kinematics/link_shapes.h"
#include "hardware/robot/path_check.h"
#include "hardware/robot/trapezoid.h"

namespace glint {

double estimated_duration_s(const ArmWithTool& arm,
                            const JointVector& from_rad,
                            const JointVector& to_rad) {
  constexpr int kSteps = 8;
  const JointVector way_rad = to_rad - from_rad;
  const double leading_rad = way_rad.cwiseAbs().maxCoeff();
  if (leading_rad == 0.0) {
    return 0.0;
  }
  double fastest_mm = 0.0;  // of a step
  PosedArm before = posed_arm(arm.arm, from_rad, arm.flange_from_tcp, arm.tool_radius_mm);
  for (int i = 1; i <= kSteps; ++i) {
    const JointVector joints_rad = from_rad + way_rad * (static_cast<double>(i) / kSteps);
    const PosedArm now = posed_arm(arm.arm, joints_rad, arm.flange_from_tcp, arm.tool_radius_mm);
    fastest_mm = std::max(fastest_mm, largest_motion_mm(now, before));
    before = now;
  }
  const double link_mm_per_rad = fastest_mm * kSteps / leading_rad;
  const double planned_mm_s = arm.limits.tool_speed_mm_s / kToolSpeedReserve;
  const double speed =
      std::min(arm.limits.joint_speed_rad_s, planned_mm_s / std::max(link_mm_per_rad, 1e-6));
  return Trapezoid(leading_rad, speed, arm.limits.joint_acceleration_rad_s2).duration_s();
}

std::size_t LegMap::add(const JointVector& joints_rad) {
  nodes_.push_back(joints_rad);
  return nodes_.size() - 1;
}

const Leg& LegMap::leg(std::size_t from, std::size_t to) {
  const Ends ends = std::minmax(from, to);
  const auto known = legs_.find(ends);
  if (known != legs_.end()) {
    return known->second;
  }
  const JointVector& start_rad = nodes_[ends.first];
  const JointVector& goal_rad = nodes_[ends.second];
  const Clearance clearance = clearance_.along(start_rad, goal_rad);
  Leg leg = {
      .is_free = clearance.is_free(), .text = clearance.text, .margin_mm = clearance.margin_mm};
  if (leg.is_free) {
    const CheckedMotion motion = check_joint_motion(cell_.arm, start_rad, goal_rad, 1.0);
    leg.is_free = motion.is_allowed();
    leg.text = motion.text;
    leg.duration_s = motion.duration_s;
  }
  return legs_.emplace(ends, std::move(leg)).first->second;
}

double LegMap::optimistic_s(std::size_t from, std::size_t to) {
  const Ends ends = std::minmax(from, to);
  if (const auto known = legs_.find(ends); known != legs_.end()) {
    return known->second.is_free ? known->second.duration_s
                                 : std::numeric_limits<double>::infinity();
  }
  const auto found = estimates_.find(ends);
  if (found != estimates_.end()) {
    return found->second;
  }
  const double estimate_s =
      estimated_duration_s(cell_.arm, nodes_[ends.first], nodes_[ends.second]);
  estimates_.emplace(ends, estimate_s);
  return estimate_s;
}

}  // namespace glint
