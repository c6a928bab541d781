// SPDX-License-Identifier: GPL-3.0-or-later
//
// Branch and bound over subsets in order of index: a branch ends when not even all that are left
// would beat the best choice, and the search when `enough` are found, which is a handful. An exact
// answer for few directions, where a greedy choice may miss one. docs/theory/coverage.md
#include "metrics/coverage/separation.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace glint {
namespace {

class Search {
 public:
  Search(std::span<const Eigen::Vector3d> directions, double separation_rad, int enough)
      : directions_(directions), max_cosine_(std::cos(separation_rad) + 1e-12), enough_(enough) {}

  int best() {
    extend(0);
    return best_;
  }

 private:
  bool is_apart(std::size_t candidate) const {
    return std::ranges::all_of(chosen_, [&](std::size_t other) {
      return directions_[candidate].dot(directions_[other]) <= max_cosine_;
    });
  }

  void extend(std::size_t first) {
    best_ = std::max(best_, static_cast<int>(chosen_.size()));
    for (std::size_t i = first; i < directions_.size() && best_ < enough_; ++i) {
      if (static_cast<int>(chosen_.size() + directions_.size() - i) <= best_) {
        return;  // not even all that are left would be more
      }
      if (is_apart(i)) {
        chosen_.push_back(i);
        extend(i + 1);
        chosen_.pop_back();
      }
    }
  }

  std::span<const Eigen::Vector3d> directions_;
  double max_cosine_;
  int enough_;
  std::vector<std::size_t> chosen_;
  int best_ = 0;
};

}  // namespace

int separated_count(std::span<const Eigen::Vector3d> directions,
                    double separation_rad,
                    int enough) {
  if (separation_rad <= 0.0) {
    return std::min(static_cast<int>(directions.size()), enough);
  }
  return Search(directions, separation_rad, enough).best();
}

}  // namespace glint
