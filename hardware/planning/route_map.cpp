// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/route_map.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

Eigen::Index index_of(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

}  // namespace

RouteMap::RouteMap(const PlanningCell& cell, const ClearanceCheck& clearance)
    : legs_(cell, clearance) {
  if (cell.safe_positions.empty()) {
    problem_ = "the cell has no safe position";
  }
  for (const SafeJoints& position : cell.safe_positions) {
    const Clearance there = clearance.at(position.joints_rad);
    if (!there.is_free()) {
      problem_ = problem_.empty()
                     ? fmt::format("safe position \"{}\": {}", position.name, there.text)
                     : problem_;
      continue;
    }
    const std::size_t node = legs_.add(position.joints_rad);
    if (safe_.empty()) {
      home_name_ = position.name;
    }
    safe_.push_back(node);
  }
  connect();
  leave_out_unreached();
}

/// Those that no way leads to from home: a view that only they are joined to has no path.
void RouteMap::leave_out_unreached() {
  std::vector<std::size_t> reached;
  for (std::size_t i = 0; i < safe_.size(); ++i) {
    if (durations_s_(0, index_of(i)) < kNoWay_s) {
      reached.push_back(safe_[i]);
    }
  }
  if (reached.size() < safe_.size()) {
    safe_ = std::move(reached);
    connect();
  }
}

/// Quickest ways between all safe positions (Floyd and Warshall).
void RouteMap::connect() {
  const std::size_t count = safe_.size();
  durations_s_ = Eigen::MatrixXd::Constant(index_of(count), index_of(count), kNoWay_s);
  ways_.assign(count * count, {});
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      const bool is_one = a == b;
      if (is_one || legs_.leg(safe_[a], safe_[b]).is_free) {
        durations_s_(index_of(a), index_of(b)) =
            is_one ? 0.0 : legs_.leg(safe_[a], safe_[b]).duration_s;
        ways_[a * count + b] = is_one ? std::vector{safe_[a]} : std::vector{safe_[a], safe_[b]};
      }
    }
  }
  for (std::size_t over = 0; over < count; ++over) {
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = 0; b < count; ++b) {
        const double sum_s =
            durations_s_(index_of(a), index_of(over)) + durations_s_(index_of(over), index_of(b));
        if (sum_s < durations_s_(index_of(a), index_of(b))) {
          durations_s_(index_of(a), index_of(b)) = sum_s;
          std::vector<std::size_t> way = ways_[a * count + over];
          const std::vector<std::size_t>& rest = ways_[over * count + b];
          way.insert(way.end(), rest.begin() + 1, rest.end());
          ways_[a * count + b] = std::move(way);
        }
      }
    }
  }
}

Route RouteMap::measured(std::vector<std::size_t> nodes) {
  Route route = {.nodes = std::move(nodes), .margin_mm = kNoWay_s};
  for (std::size_t i = 1; i < route.nodes.size(); ++i) {
    const Leg& leg = legs_.leg(route.nodes[i - 1], route.nodes[i]);
    route.margin_mm = std::min(route.margin_mm, leg.margin_mm);
    route.duration_s += leg.duration_s;
  }
  return route;
}

std::optional<Route> RouteMap::route(std::size_t from, std::size_t to) {
  if (legs_.leg(from, to).is_free) {
    return measured({from, to});
  }
  return over_safe(from, to);
}

namespace {

/// `nodes` with both ends, where it does not have them already.
std::vector<std::size_t> between(std::size_t from, std::vector<std::size_t> nodes, std::size_t to) {
  if (nodes.front() != from) {
    nodes.insert(nodes.begin(), from);
  }
  if (nodes.back() != to) {
    nodes.push_back(to);
  }
  return nodes;
}

}  // namespace

std::optional<Route> RouteMap::over_safe(std::size_t from, std::size_t to) {
  const std::size_t count = safe_.size();
  double min_s = kNoWay_s;
  std::vector<std::size_t> best;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      const bool is_joined = durations_s_(index_of(a), index_of(b)) < kNoWay_s &&
                             (safe_[a] == from || legs_.leg(from, safe_[a]).is_free) &&
                             (safe_[b] == to || legs_.leg(safe_[b], to).is_free);
      if (!is_joined) {
        continue;
      }
      std::vector<std::size_t> nodes = between(from, ways_[a * count + b], to);
      const double duration_s = measured(nodes).duration_s;
      if (duration_s < min_s && nodes.size() > 1) {
        min_s = duration_s;
        best = std::move(nodes);
      }
    }
  }
  return best.empty() ? std::nullopt : std::optional(measured(std::move(best)));
}

double RouteMap::optimistic_s(std::size_t from, std::size_t to) {
  const double straight_s = legs_.optimistic_s(from, to);
  if (straight_s < kNoWay_s) {
    return straight_s;
  }
  if (const std::optional<Route> route = over_safe(from, to)) {
    return route->duration_s;
  }
  return kNoWay_s;
}

}  // namespace glint
