// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/robust/robust_optimum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "core/rng.h"

namespace glint {
namespace {

using Merits = std::vector<double>;
using Draw = std::vector<std::size_t>;

constexpr int kSamples = 2000;
/// A candidate that leads in fewer samples of the bootstrap is given up.
constexpr double kHopeless = 0.01;

Merits merits_of(const BuiltMerit& merit, const BuiltScores& built) {
  Merits merits;
  for (const std::optional<Scores>& scores : built) {
    merits.push_back(scores ? merit.of(*scores) : kNoMerit);
  }
  return merits;
}

Standing drawn_standing(const Merits& merits, const Draw& draw) {
  Merits drawn;
  for (const std::size_t k : draw) {
    drawn.push_back(merits[k]);
  }
  return standing_of(std::move(drawn));
}

/// Built designs drawn with replacement, the same ones for all candidates.
std::vector<Draw> draws_of(std::size_t count) {
  Rng rng(1, Stream::kResampling, 1);
  std::vector<Draw> draws(kSamples, Draw(count));
  for (Draw& draw : draws) {
    for (std::size_t& k : draw) {
      k = std::min(count - 1, static_cast<std::size_t>(rng.uniform() * static_cast<double>(count)));
    }
  }
  return draws;
}

/// In which share of the draws a is better than b; level ones count half.
double share_better(const Merits& a, const Merits& b, const std::vector<Draw>& draws) {
  double sum = 0.0;
  for (const Draw& draw : draws) {
    const Standing standing_a = drawn_standing(a, draw);
    const Standing standing_b = drawn_standing(b, draw);
    sum += standing_a < standing_b ? 1.0 : standing_a == standing_b ? 0.5 : 0.0;
  }
  return sum / static_cast<double>(draws.size());
}

BuiltInterval interval_of(double value, std::vector<double> samples) {
  constexpr double kTail = 0.025;
  std::ranges::sort(samples);
  const auto at = [&](double share) {
    return samples[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(samples.size() - 1)))];
  };
  return {.value = value, .low = at(kTail), .high = at(1.0 - kTail)};
}

/// b - a, where both are finite or one is not; equal infinities differ by nothing.
double difference(double a, double b) {
  return a == b ? 0.0 : b - a;
}

class Race {
 public:
  Race(const RobustTask& task, const BuildDesigns& build)
      : task_(task), build_(build), merit_(task.goal, task.trials, task.front) {}

  void add(Point point, std::optional<double> modelled) {
    found_.candidates.push_back({.point = std::move(point), .modelled = modelled});
    merits_.emplace_back();
    racing_.push_back(found_.candidates.size() - 1);
  }

  /// @return false: interrupted
  bool run() {
    const auto all = static_cast<int>(task_.offsets.size());
    for (int first = 0; first < all; first += kRacePart) {
      if (!build_part(first, std::min(kRacePart, all - first))) {
        return false;
      }
      find_best();
      if (first + kRacePart < all) {
        give_up();
      }
    }
    return true;
  }

  RobustOptimum result() {
    const std::vector<Draw> draws = draws_of(task_.offsets.size());
    const Merits& winner = merits_.front();
    const Merits& robust = merits_[found_.best];
    std::vector<double> of_winner;
    std::vector<double> of_robust;
    std::vector<double> gains;
    for (const Draw& draw : draws) {
      of_winner.push_back(drawn_standing(winner, draw).reached);
      of_robust.push_back(drawn_standing(robust, draw).reached);
      gains.push_back(difference(of_robust.back(), of_winner.back()));
    }
    const double nominal = found_.candidates.front().standing.reached;
    const double reached = found_.candidates[found_.best].standing.reached;
    found_.winner = interval_of(nominal, std::move(of_winner));
    found_.robust = interval_of(reached, std::move(of_robust));
    found_.gain = interval_of(difference(reached, nominal), std::move(gains));
    found_.probability = found_.best == 0 ? 0.0 : share_better(robust, winner, draws);
    return found_;
  }

 private:
  bool build_part(int first, int count) {
    std::vector<Point> points;
    for (const std::size_t index : racing_) {
      points.push_back(found_.candidates[index].point);
    }
    std::vector<BuiltScores> parts = build_(points, first, count);
    if (parts.size() != points.size()) {
      return false;
    }
    for (std::size_t k = 0; k < racing_.size(); ++k) {
      RobustCandidate& candidate = found_.candidates[racing_[k]];
      candidate.built.insert(candidate.built.end(), parts[k].begin(), parts[k].end());
      merits_[racing_[k]] = merits_of(merit_, candidate.built);
      candidate.standing = standing_of(merits_[racing_[k]]);
      found_.evaluations += count;
    }
    return true;
  }

  /// Of equals the first, so that the winner stays where nothing is better.
  void find_best() {
    found_.best = *std::ranges::min_element(
        racing_, {}, [this](std::size_t index) { return found_.candidates[index].standing; });
  }

  /// The winner stays: it is what the robust design is compared with.
  void give_up() {
    const std::vector<Draw> draws = draws_of(merits_[found_.best].size());
    std::erase_if(racing_, [&](std::size_t index) {
      return index != 0 && index != found_.best &&
             share_better(merits_[index], merits_[found_.best], draws) < kHopeless;
    });
  }

  const RobustTask& task_;
  const BuildDesigns& build_;
  BuiltMerit merit_;
  RobustOptimum found_;
  std::vector<Merits> merits_;       ///< of each candidate
  std::vector<std::size_t> racing_;  ///< indices of candidates, the winner first
};

}  // namespace

std::optional<RobustOptimum> find_robust_optimum(const RobustTask& task,
                                                 const Point& winner,
                                                 const BuildDesigns& build) {
  Race race(task, build);
  race.add(winner, std::nullopt);
  for (Proposal& proposal : propose_robust(task, winner, kRobustCandidates)) {
    race.add(std::move(proposal.point), proposal.modelled);
  }
  return race.run() ? std::optional(race.result()) : std::nullopt;
}

}  // namespace glint
