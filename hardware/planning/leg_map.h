// SPDX-License-Identifier: GPL-3.0-or-later
//
// Straight ways of the joints between standstills, each looked at when it is asked for and once.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hardware/planning/clearance.h"

namespace glint {

struct Leg {
  bool is_free = false;
  std::string text;  ///< why not
  double margin_mm = 0.0;
  double duration_s = 0.0;
};

/// About how long a movej takes: the leading joint's trapezoid, slower where a link would be too
/// fast at one of nine samples. check_joint_motion() tells it to 2 %.
double estimated_duration_s(const ArmWithTool& arm,
                            const JointVector& from_rad,
                            const JointVector& to_rad);

/// Nodes are joints by their number. A leg there and back is the same.
class LegMap {
 public:
  /// @param cell, clearance  outlive it
  LegMap(const PlanningCell& cell, const ClearanceCheck& clearance)
      : cell_(cell), clearance_(clearance) {}

  /// @return the node's number, counted from 0
  std::size_t add(const JointVector& joints_rad);

  const JointVector& joints_rad(std::size_t node) const { return nodes_[node]; }

  /// Free by ClearanceCheck and by check_joint_motion(), which the robot asks before it moves.
  const Leg& leg(std::size_t from, std::size_t to);

  /// Its duration when it was looked at, infinity when it is not free, else the estimate.
  double optimistic_s(std::size_t from, std::size_t to);

 private:
  using Ends = std::pair<std::size_t, std::size_t>;

  const PlanningCell& cell_;
  const ClearanceCheck& clearance_;
  std::vector<JointVector> nodes_;
  std::map<Ends, Leg> legs_;
  std::map<Ends, double> estimates_;
};

}  // namespace glint
