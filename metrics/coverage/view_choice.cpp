// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/coverage/view_choice.h"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "core/error.h"
#include "metrics/coverage/coverage.h"

namespace glint {
namespace {

/// A choice must be better by more than this to be another one: rounding of sums.
constexpr double kTie = 1e-12;

/// Points that are seen by the same views, as one, with their share of all weights.
struct JoinedPoints {
  std::vector<double> shares;
  std::vector<std::vector<std::uint32_t>> of_view;  ///< which a view sees, ascending
};

/// The views that see a point, a bit each. @return there is one
bool mark_views(const Visibility& visibility,
                std::size_t point,
                std::vector<std::uint64_t>& views) {
  std::ranges::fill(views, 0);
  bool is_seen = false;
  for (std::size_t view = 0; view < visibility.num_views(); ++view) {
    if (visibility.sees(view, point)) {
      views[view / 64] |= std::uint64_t{1} << (view % 64);
      is_seen = true;
    }
  }
  return is_seen;
}

JoinedPoints joined_points(const Visibility& visibility, std::span<const double> weights) {
  const double whole = checked_sum(weights);
  const std::size_t words = (visibility.num_views() + 63) / 64;
  JoinedPoints joined;
  joined.of_view.resize(visibility.num_views());
  std::map<std::vector<std::uint64_t>, std::size_t> known;
  std::vector<std::uint64_t> views(words);
  for (std::size_t point = 0; point < weights.size(); ++point) {
    if (!mark_views(visibility, point, views) || weights[point] == 0.0) {
      continue;
    }
    const auto [at, is_new] = known.try_emplace(views, joined.shares.size());
    if (is_new) {
      for (std::size_t view = 0; view < visibility.num_views(); ++view) {
        if (visibility.sees(view, point)) {
          joined.of_view[view].push_back(static_cast<std::uint32_t>(joined.shares.size()));
        }
      }
      joined.shares.push_back(0.0);
    }
    joined.shares[at->second] += weights[point] / whole;
  }
  return joined;
}

/// What is seen so far.
class Seen {
 public:
  explicit Seen(const JoinedPoints& points) : points_(points), counts_(points.shares.size()) {}

  double gain(std::size_t view) const {
    double sum = 0.0;
    for (const std::uint32_t point : points_.of_view[view]) {
      sum += counts_[point] == 0 ? points_.shares[point] : 0.0;
    }
    return sum;
  }

  void add(std::size_t view) {
    for (const std::uint32_t point : points_.of_view[view]) {
      ++counts_[point];
    }
  }

  void remove(std::size_t view) {
    for (const std::uint32_t point : points_.of_view[view]) {
      --counts_[point];
    }
  }

  double share() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      sum += counts_[i] > 0 ? points_.shares[i] : 0.0;
    }
    return sum;
  }

 private:
  const JoinedPoints& points_;
  std::vector<std::int32_t> counts_;
};

/// Takes views one after the other, always that which adds most; of equal ones the first.
ViewChoice greedy_among(const JoinedPoints& points, std::vector<std::size_t> views, std::size_t k) {
  Seen seen(points);
  ViewChoice choice;
  while (choice.views.size() < k) {
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const double gain = seen.gain(views[i]);
      if (gain > most + kTie) {
        best = i;
        most = gain;
      }
    }
    choice.views.push_back(views[best]);
    seen.add(views[best]);
    views.erase(views.begin() + static_cast<std::ptrdiff_t>(best));
  }
  choice.share = seen.share();
  return choice;
}

class BranchAndBound {
 public:
  BranchAndBound(const JoinedPoints& points, ViewChoice start, std::int64_t max_nodes)
      : seen_(points), count_(start.views.size()), max_nodes_(max_nodes), best_(std::move(start)) {}

  ViewChoice solve(const std::vector<std::size_t>& views) {
    best_.is_proven = branch(views, 0.0);
    return best_;
  }

 private:
  struct Candidate {
    std::size_t view = 0;
    double gain = 0.0;
  };

  std::vector<Candidate> best_first(const std::vector<std::size_t>& views) const {
    std::vector<Candidate> candidates;
    for (const std::size_t view : views) {
      candidates.push_back({.view = view, .gain = seen_.gain(view)});
    }
    std::ranges::stable_sort(candidates, std::ranges::greater(), &Candidate::gain);
    return candidates;
  }

  /// Everything that can be reached with the views that are left.
  /// @return false when there were too many nodes
  bool branch(const std::vector<std::size_t>& views, double share) {
    if (++best_.nodes > max_nodes_) {
      return false;
    }
    const std::vector<Candidate> candidates = best_first(views);
    const std::size_t left = count_ - chosen_.size();
    if (left == 1) {
      take(candidates.front(), share);
      return true;
    }
    std::vector<std::size_t> others(views.size());
    std::ranges::transform(candidates, others.begin(), &Candidate::view);
    for (std::size_t i = 0; i + left <= candidates.size(); ++i) {
      double bound = share;
      for (std::size_t k = i; k < i + left; ++k) {
        bound += candidates[k].gain;
      }
      if (bound <= best_.share + kTie) {
        return true;
      }
      others.erase(others.begin());
      chosen_.push_back(candidates[i].view);
      seen_.add(candidates[i].view);
      const bool is_whole = branch(others, share + candidates[i].gain);
      seen_.remove(candidates[i].view);
      chosen_.pop_back();
      if (!is_whole) {
        return false;
      }
    }
    return true;
  }

  void take(const Candidate& last, double share) {
    if (share + last.gain > best_.share + kTie) {
      best_.share = share + last.gain;
      best_.views = chosen_;
      best_.views.push_back(last.view);
    }
  }

  Seen seen_;
  std::size_t count_;
  std::int64_t max_nodes_;
  std::vector<std::size_t> chosen_;
  ViewChoice best_;
};

std::size_t checked_count(const Visibility& visibility, int count) {
  if (count < 1) {
    throw ConfigError(fmt::format("{} views are to be chosen, must be at least 1", count));
  }
  return std::min(static_cast<std::size_t>(count), visibility.num_views());
}

std::vector<std::size_t> all_views(const Visibility& visibility) {
  std::vector<std::size_t> views(visibility.num_views());
  std::iota(views.begin(), views.end(), std::size_t{0});
  return views;
}

}  // namespace

ViewChoice choose_greedy(const Visibility& visibility, std::span<const double> weights, int count) {
  GLINT_CHECK(visibility.num_points() == weights.size(), "one weight a point");
  const std::size_t k = checked_count(visibility, count);
  ViewChoice choice = greedy_among(joined_points(visibility, weights), all_views(visibility), k);
  choice.is_proven = k <= 1 || k == visibility.num_views();
  return choice;
}

ViewChoice choose_exact(const Visibility& visibility,
                        std::span<const double> weights,
                        int count,
                        std::int64_t max_nodes) {
  GLINT_CHECK(visibility.num_points() == weights.size(), "one weight a point");
  const std::size_t k = checked_count(visibility, count);
  const JoinedPoints points = joined_points(visibility, weights);
  ViewChoice greedy = greedy_among(points, all_views(visibility), k);
  if (k <= 1 || k == visibility.num_views()) {
    greedy.is_proven = true;
    return greedy;
  }
  const ViewChoice best =
      BranchAndBound(points, std::move(greedy), max_nodes).solve(all_views(visibility));
  ViewChoice ordered = greedy_among(points, best.views, k);
  ordered.is_proven = best.is_proven;
  ordered.nodes = best.nodes;
  return ordered;
}

}  // namespace glint
