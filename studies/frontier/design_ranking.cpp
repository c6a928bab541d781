// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/design_ranking.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/cpu_clock.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/definition/ladder/larger_pixels.h"
#include "studies/evaluation/evaluation.h"
#include "studies/frontier/frontier_methods.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kDesigns = 12;
constexpr int kMaxTries = 4 * kDesigns;  ///< designs may be impossible
constexpr std::uint64_t kDesignSeed = 79;
constexpr int kFirstPicture = 100;  ///< random numbers that nothing else on the frontier has
constexpr double kAtLeast = 1.5;    ///< times the reference's time for all of it
constexpr double kRankingReferenceShare = 0.6;  ///< of the budget

/// The scene's own but for its method and the size of its pixels.
bool is_plain(const FrontierPoint& point, const Frontier& frontier) {
  return point.problem.empty() && point.realisation.empty() &&
         point.tessellation == frontier.points.front().tessellation;
}

/// One of those that differ from the reference in the number of their rays or samples alone.
bool is_of_ladder(const FrontierPoint& point, const Frontier& frontier) {
  const ComparedMethod& first = frontier.points.front().method;
  return is_plain(point, frontier) && point.reduction == 1 && !point.is_reference &&
         point.method.kind == first.kind &&
         point.method.paths.max_reflections == first.paths.max_reflections;
}

class Ranking {
 public:
  Ranking(const Study& study, const Frontier& frontier, const RankingOptions& options)
      : study_(study),
        frontier_(frontier),
        options_(options),
        pool_(options.threads),
        wanted_(wanted_by(study.goal)) {}

  std::optional<DesignRanking> run() {
    if (!wanted_.trials.empty()) {
      return std::nullopt;
    }
    const FrontierPoint* reference = choose_reference();
    if (reference == nullptr || !measure_reference(*reference)) {
      return std::nullopt;
    }
    DesignRanking ranking = {.score = study_.goal.objective.name,
                             .reference = reference->label,
                             .designs = static_cast<int>(scenes_.size()),
                             .mean_error = errors_.front()};
    // A machine that others use as well may have taken longer than was foreseen.
    const double end_s = std::max(options_.budget_s, kAtLeast * seconds());
    for (const FrontierPoint* point : cheaper_than(*reference)) {
      if (seconds() + seconds_of(*point) < end_s) {
        rank(*point, ranking);
      }
    }
    return ranking.methods.empty() ? std::nullopt : std::optional(ranking);
  }

 private:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// Wall clock of all designs by a method, about; each is a first one.
  double seconds_of(const FrontierPoint& point) const {
    return kDesigns * std::max(point.cold_s, point.cpu_s) / options_.threads;
  }

  void tell(const std::string& next) const {
    if (options_.on_progress) {
      options_.on_progress(std::min(1.0, seconds() / options_.budget_s), "designs: " + next);
    }
  }

  const FrontierPoint* choose_reference() const {
    constexpr double kTwoPictures = 2.0;
    const FrontierPoint* reference = nullptr;
    for (const FrontierPoint& point : frontier_.points) {
      if (is_of_ladder(point, frontier_) &&
          kTwoPictures * seconds_of(point) < kRankingReferenceShare * options_.budget_s &&
          (reference == nullptr || point.cpu_s > reference->cpu_s)) {
        reference = &point;
      }
    }
    return reference;
  }

  std::vector<const FrontierPoint*> cheaper_than(const FrontierPoint& reference) const {
    std::vector<const FrontierPoint*> points;
    for (const FrontierPoint& point : frontier_.points) {
      if (is_plain(point, frontier_) && point.cpu_s < reference.cpu_s && !point.is_reference) {
        points.push_back(&point);
      }
    }
    std::ranges::sort(points, {}, &FrontierPoint::cpu_s);
    return points;
  }

  /// What the search minimises; empty where the scene cannot be made or scored.
  std::optional<double> figure_of(SceneStore& store,
                                  const FrontierPoint& point,
                                  const SceneSettings& design,
                                  int picture) const {
    SceneSettings scene = scene_of(point, design);
    if (point.method.follows_paths) {
      scene = independent_paths(scene, scene.paths.samples, picture);
    }
    try {
      const Scores scores = evaluate(store, scene, {}, wanted_).scores;
      const auto found = scores.find(study_.goal.objective.name);
      if (found == scores.end() || !std::isfinite(found->second)) {
        return std::nullopt;
      }
      return study_.goal.objective.is_maximised ? -found->second : found->second;
    } catch (const ConfigError&) {
      return std::nullopt;
    }
  }

  std::optional<SceneSettings> design(std::uint32_t index) const {
    const Sobol sequence(kDesignSeed, static_cast<int>(study_.space.variables.size()));
    try {
      const Point point = point_from_unit(study_.space, sequence.point(index));
      return with_larger_pixels(scene_with(study_, overrides_of(study_, point)),
                                frontier_.pixel_factor);
    } catch (const ConfigError&) {
      return std::nullopt;
    }
  }

  bool measure_reference(const FrontierPoint& reference) {
    const FrontierPoint* coarser = nullptr;
    for (const FrontierPoint& point : frontier_.points) {
      if (is_of_ladder(point, frontier_) && point.cpu_s < reference.cpu_s &&
          (coarser == nullptr || point.cpu_s > coarser->cpu_s)) {
        coarser = &point;
      }
    }
    if (coarser == nullptr) {
      return false;
    }
    SceneStore store(pool_);
    SceneStore other_store(pool_);
    const FrontierPoint& other = reference.method.follows_paths ? reference : *coarser;
    const double share = reference.method.follows_paths ? 0.25 : 1.0;  // mean of two
    double squares = 0.0;
    for (int i = 0; i < kMaxTries && static_cast<int>(scenes_.size()) < kDesigns; ++i) {
      tell("reference, " + std::to_string(i + 1));
      const auto scene = design(static_cast<std::uint32_t>(i));
      const auto one =
          scene ? figure_of(store, reference, *scene, kFirstPicture + 1) : std::optional<double>();
      const auto two =
          one ? figure_of(other_store, other, *scene, kFirstPicture + 2) : std::nullopt;
      if (two) {
        scenes_.push_back(*scene);
        figures_.push_back(reference.method.follows_paths ? 0.5 * (*one + *two) : *one);
        squares += share * (*one - *two) * (*one - *two);
      }
    }
    if (scenes_.size() < 3) {
      return false;
    }
    errors_.assign(scenes_.size(), std::sqrt(squares / static_cast<double>(scenes_.size())));
    return true;
  }

  void rank(const FrontierPoint& point, DesignRanking& ranking) {
    tell(point.label);
    SceneStore store(pool_);
    std::vector<double> cheap;
    const double start = process_cpu_s();
    for (const SceneSettings& scene : scenes_) {
      const auto figure = figure_of(store, point, scene, kFirstPicture);
      if (!figure) {
        return;
      }
      cheap.push_back(*figure);
    }
    MethodRanking row = {.label = point.label,
                         .cpu_s = (process_cpu_s() - start) / static_cast<double>(cheap.size()),
                         .agreement = rank_agreement(cheap, figures_, errors_)};
    row.is_right = is_ranking_right(row.agreement);
    ranking.methods.push_back(row);
  }

  Clock::time_point start_ = Clock::now();
  const Study& study_;
  const Frontier& frontier_;
  const RankingOptions& options_;
  ThreadPool pool_;
  WantedScores wanted_;
  std::vector<SceneSettings> scenes_;
  std::vector<double> figures_;  ///< of the reference, smaller is better
  std::vector<double> errors_;   ///< their standard errors
};

}  // namespace

std::optional<DesignRanking> rank_designs(const Study& study,
                                          const Frontier& frontier,
                                          const RankingOptions& options) {
  if (!study.has_search() || !study.has_objective) {
    return std::nullopt;
  }
  return Ranking(study, frontier, options).run();
}

}  // namespace glint
