// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/view_stops.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

namespace glint {
namespace {

/// Joints that may be tried, and how long they take from a safe position at least.
struct Candidate {
  const JointChoice* branch = nullptr;
  JointVector joints_rad = JointVector::Zero();
  double away_s = 0.0;
};

double away_s(const PlanningCell& cell, const RouteMap& routes, const JointVector& joints_rad) {
  double min_s = std::numeric_limits<double>::infinity();
  for (const std::size_t safe : routes.safe()) {
    min_s =
        std::min(min_s, estimated_duration_s(cell.arm, routes.legs().joints_rad(safe), joints_rad));
  }
  return min_s;
}

/// For each branch and each safe position the turns nearest to it.
std::vector<Candidate> near_candidates(const JointChoices& choices, const RouteMap& routes) {
  std::vector<Candidate> candidates;
  for (const JointChoice& branch : choices.accepted) {
    for (const std::size_t safe : routes.safe()) {
      const JointVector& safe_rad = routes.legs().joints_rad(safe);
      const JointVector& nearest = *std::ranges::min_element(
          branch.turns_rad, {}, [&safe_rad](const JointVector& joints_rad) {
            return (joints_rad - safe_rad).cwiseAbs().maxCoeff();
          });
      const bool is_new = std::ranges::none_of(candidates, [&](const Candidate& known) {
        return known.branch == &branch && known.joints_rad == nearest;
      });
      if (is_new) {
        candidates.push_back({.branch = &branch, .joints_rad = nearest});
      }
    }
  }
  return candidates;
}

std::vector<Candidate> all_candidates(const JointChoices& choices) {
  std::vector<Candidate> candidates;
  for (const JointChoice& branch : choices.accepted) {
    for (const JointVector& joints_rad : branch.turns_rad) {
      candidates.push_back({.branch = &branch, .joints_rad = joints_rad});
    }
  }
  return candidates;
}

void sort_by_time(const PlanningCell& cell,
                  const RouteMap& routes,
                  std::vector<Candidate>& candidates) {
  for (Candidate& candidate : candidates) {
    candidate.away_s = away_s(cell, routes, candidate.joints_rad);
  }
  std::ranges::stable_sort(candidates, {}, &Candidate::away_s);
}

/// A straight free way to a safe position.
bool is_joined(RouteMap& routes, std::size_t node, std::string& text) {
  for (const std::size_t safe : routes.safe()) {
    const Leg& leg = routes.legs().leg(safe, node);
    if (leg.is_free) {
      return true;
    }
    text = text.empty() ? leg.text : text;
  }
  return false;
}

/// Adds those with a free way to the stop. @param tries  candidates that are looked at, at most
void add_joined(RouteMap& routes,
                const std::vector<Candidate>& candidates,
                std::size_t tries,
                std::size_t most,
                Stop& stop) {
  for (std::size_t i = 0; i < std::min(tries, candidates.size()) && stop.choices.size() < most;
       ++i) {
    const std::size_t node = routes.legs().add(candidates[i].joints_rad);
    if (is_joined(routes, node, stop.reason)) {
      stop.choices.push_back({.node = node,
                              .singularity = candidates[i].branch->singularity,
                              .margin_mm = candidates[i].branch->margin_mm});
    }
  }
}

}  // namespace

Stop find_stop(const PlanningCell& cell,
               const ClearanceCheck& clearance,
               RouteMap& routes,
               const Eigen::Isometry3d& base_from_flange,
               std::size_t most) {
  constexpr std::size_t kTries = 12;
  constexpr std::size_t kMoreTries = 48;
  const JointChoices choices = choices_of(cell, clearance, base_from_flange);
  if (choices.outcome != ViewOutcome::kPlanned) {
    return {.outcome = choices.outcome, .reason = choices.reason};
  }
  if (!routes.has_home()) {
    return {.outcome = ViewOutcome::kNoPath, .reason = routes.problem()};
  }
  Stop stop;
  std::vector<Candidate> candidates = near_candidates(choices, routes);
  sort_by_time(cell, routes, candidates);
  add_joined(routes, candidates, kTries, most, stop);
  if (stop.choices.empty()) {
    candidates = all_candidates(choices);
    sort_by_time(cell, routes, candidates);
    add_joined(routes, candidates, kMoreTries, 1, stop);
  }
  if (stop.choices.empty()) {
    stop.outcome = ViewOutcome::kNoPath;
    stop.reason =
        fmt::format("no way from a safe position is free; on the shortest {}", stop.reason);
  } else {
    stop.reason.clear();
  }
  return stop;
}

}  // namespace glint
