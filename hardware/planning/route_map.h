// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ways between standstills: straight, or over the safe positions of the cell.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "hardware/planning/leg_map.h"

namespace glint {

/// Duration of a way that cannot be gone.
inline constexpr double kNoWay_s = std::numeric_limits<double>::infinity();

/// Joints from one standstill to another, each leg free.
struct Route {
  std::vector<std::size_t> nodes;  ///< of the LegMap, both ends included
  double margin_mm = 0.0;          ///< smallest of its legs
  double duration_s = 0.0;         ///< sum of its legs
};

/// The safe positions that can be used, and the ways over them.
class RouteMap {
 public:
  /// Takes the safe positions that are free and can be reached from the first one that is free.
  /// @param cell, clearance  outlive it
  RouteMap(const PlanningCell& cell, const ClearanceCheck& clearance);

  /// Whether there is any safe position; problem() tells why not.
  bool has_home() const { return !safe_.empty(); }

  const std::string& problem() const { return problem_; }

  /// Where tours begin and end.
  std::size_t home() const { return safe_.front(); }

  const std::string& home_name() const { return home_name_; }

  const std::vector<std::size_t>& safe() const { return safe_; }

  LegMap& legs() { return legs_; }

  const LegMap& legs() const { return legs_; }

  /// Straight when that is free, else the quickest over safe positions; none: no way is free.
  std::optional<Route> route(std::size_t from, std::size_t to);

  /// Duration of route() when all its legs have been looked at, else an estimate below it.
  double optimistic_s(std::size_t from, std::size_t to);

 private:
  void connect();
  void leave_out_unreached();
  std::optional<Route> over_safe(std::size_t from, std::size_t to);
  Route measured(std::vector<std::size_t> nodes);

  LegMap legs_;
  std::vector<std::size_t> safe_;               ///< nodes
  std::vector<std::vector<std::size_t>> ways_;  ///< between safe a and b at a * count + b
  Eigen::MatrixXd durations_s_;                 ///< of these
  std::string home_name_;
  std::string problem_;
};

}  // namespace glint
