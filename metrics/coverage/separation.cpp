// SPDX-License-Identifier: GPL-3.0-or-later
//
// Branch and bound. Candidates are divided into groups of directions that are all closer together
// than the separation: of a group at most one can be chosen, so that a choice has at most as many
// more as there are groups. It is the largest clique of the graph that links directions far enough
// apart, and the groups are its colours.
//
// Source: E. Tomita and T. Seki, "An efficient branch-and-bound algorithm for finding a maximum
// clique", DMTCS 2003, LNCS 2731 (bound and order by colours).
#include "metrics/coverage/separation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace glint {
namespace {

using Candidates = std::vector<std::size_t>;

class Search {
 public:
  Search(std::span<const Eigen::Vector3d> directions, double separation_rad, int enough)
      : directions_(directions), max_cosine_(std::cos(separation_rad) + 1e-12), enough_(enough) {}

  int best() {
    Candidates all(directions_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    best_ = taken_in_order(all);
    if (best_ < enough_) {
      extend(0, all);
    }
    return best_;
  }

  std::int64_t nodes() const { return nodes_; }

 private:
  bool are_apart(std::size_t one, std::size_t other) const {
    return directions_[one].dot(directions_[other]) <= max_cosine_;
  }

  /// A choice to begin with: one candidate after the other that is apart from those before it.
  int taken_in_order(const Candidates& candidates) const {
    Candidates taken;
    for (const std::size_t candidate : candidates) {
      if (static_cast<int>(taken.size()) >= enough_) {
        break;
      }
      if (std::ranges::all_of(taken, [&](std::size_t t) { return are_apart(candidate, t); })) {
        taken.push_back(candidate);
      }
    }
    return static_cast<int>(taken.size());
  }

  /// Each candidate goes into the first group that has none apart from it.
  std::vector<Candidates> grouped(const Candidates& candidates) const {
    std::vector<Candidates> groups;
    for (const std::size_t candidate : candidates) {
      const auto is_near = [&](std::size_t member) { return !are_apart(candidate, member); };
      const auto group = std::ranges::find_if(
          groups, [&](const Candidates& members) { return std::ranges::all_of(members, is_near); });
      (group != groups.end() ? *group : groups.emplace_back()).push_back(candidate);
    }
    return groups;
  }

  /// @param chosen      directions that are chosen already
  /// @param candidates  those apart from all of them that may come beside them
  void extend(int chosen, const Candidates& candidates) {
    ++nodes_;
    best_ = std::max(best_, chosen);
    std::vector<Candidates> groups = grouped(candidates);
    // Choices with a member of the last group come first, then those without it.
    while (!groups.empty() && best_ < enough_) {
      if (chosen + static_cast<int>(groups.size()) <= best_) {
        return;  // not even one of each group would be more
      }
      const std::size_t next = groups.back().back();
      groups.back().pop_back();
      if (groups.back().empty()) {
        groups.pop_back();
      }
      Candidates rest;
      for (const Candidates& group : groups) {
        std::ranges::copy_if(
            group, std::back_inserter(rest), [&](std::size_t i) { return are_apart(next, i); });
      }
      extend(chosen + 1, rest);
    }
  }

  std::span<const Eigen::Vector3d> directions_;
  double max_cosine_;
  int enough_;
  int best_ = 0;
  std::int64_t nodes_ = 0;
};

}  // namespace

int separated_count(std::span<const Eigen::Vector3d> directions,
                    double separation_rad,
                    int enough,
                    std::int64_t* nodes) {
  if (separation_rad <= 0.0) {
    return std::min(static_cast<int>(directions.size()), enough);
  }
  Search search(directions, separation_rad, enough);
  const int count = search.best();
  if (nodes != nullptr) {
    *nodes = search.nodes();
  }
  return count;
}

}  // namespace glint
