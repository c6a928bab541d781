// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/design_ranking.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <set>

#include "core/cpu_clock.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/accuracy/search_figures.h"
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

double mean_error_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Each once.
std::vector<std::string> scores_in(const Goal& goal) {
  std::set<std::string> names;
  for (const Objective& objective : objectives_of(goal)) {
    names.insert(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    names.insert(constraint.name);
  }
  return {names.begin(), names.end()};
}

bool is_finite(const Scores& scores) {
  return std::ranges::all_of(scores, [](const auto& score) { return std::isfinite(score.second); });
}

class Ranking {
 public:
  Ranking(const Study& study, const Frontier& frontier, const RankingOptions& options)
      : study_(study),
        frontier_(frontier),
        options_(options),
        pool_(options.threads),
        wanted_(wanted_by(study.goal)),
        names_(scores_in(study.goal)) {}

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
                             .mean_error = mean_error_of(errors_.front())};
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

  /// Those of the goal; empty where the scene cannot be made or judged.
  std::optional<Scores> scores_of(SceneStore& store,
                                  const FrontierPoint& point,
                                  const SceneSettings& design,
                                  int picture) const {
    SceneSettings scene = scene_of(point, design);
    if (point.method.is_noisy) {
      scene = independent_paths(scene, scene.paths.samples, picture);
    }
    try {
      const Scores all = evaluate(store, scene, {}, wanted_).scores;
      if (!problem_with(study_.goal, all).empty()) {
        return std::nullopt;
      }
      Scores scores;
      for (const std::string& name : names_) {
        scores[name] = all.at(name);
      }
      return is_finite(scores) ? std::optional(scores) : std::nullopt;
    } catch (const ConfigError&) {
      return std::nullopt;
    }
  }

  /// Its choices are those of the branch: before variables that do not count get their middle.
  std::vector<double> in_own_branch(std::vector<double> unit) const {
    if (frontier_.branch) {
      const std::vector<double> own =
          unit_from_point(study_.space, baseline_of(study_, *frontier_.split, *frontier_.branch));
      for (const BranchChoice& choice : frontier_.split->choices) {
        unit[choice.variable] = own[choice.variable];
      }
    }
    return unit;
  }

  std::optional<SceneSettings> design(std::uint32_t index) const {
    const Sobol sequence(kDesignSeed, static_cast<int>(study_.space.variables.size()));
    try {
      const Point point = point_from_unit(study_.space, in_own_branch(sequence.point(index)));
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
    const bool has_noise = reference.method.is_noisy;
    score_reference(reference, has_noise ? reference : *coarser, has_noise);
    if (scenes_.size() < 3) {
      return false;
    }
    figures_ = search_figures(study_.goal, scores_);
    errors_ = search_figure_errors(study_.goal, scores_);
    return true;
  }

  /// @param has_noise  `other` is the same with other random numbers: the mean of both is taken
  void score_reference(const FrontierPoint& reference, const FrontierPoint& other, bool has_noise) {
    SceneStore store(pool_);
    SceneStore other_store(pool_);
    Scores squares;
    for (int i = 0; i < kMaxTries && static_cast<int>(scenes_.size()) < kDesigns; ++i) {
      tell("reference, " + std::to_string(i + 1));
      const auto scene = design(static_cast<std::uint32_t>(i));
      const auto one =
          scene ? scores_of(store, reference, *scene, kFirstPicture + 1) : std::nullopt;
      const auto two =
          one ? scores_of(other_store, other, *scene, kFirstPicture + 2) : std::nullopt;
      if (!two) {
        continue;
      }
      scenes_.push_back(*scene);
      scores_.push_back(*one);
      for (const std::string& name : names_) {
        const double step = 0.5 * (two->at(name) - one->at(name));
        scores_.back()[name] += has_noise ? step : 0.0;
        squares[name] += has_noise ? step * step : 4.0 * step * step;
      }
    }
    for (Scores& scores : scores_) {
      for (const std::string& name : names_) {
        scores[error_name(without_bound(name))] =
            std::sqrt(squares.at(name) / static_cast<double>(scores_.size()));
      }
    }
  }

  void rank(const FrontierPoint& point, DesignRanking& ranking) {
    tell(point.label);
    SceneStore store(pool_);
    std::vector<Scores> cheap;
    const double start = process_cpu_s();
    for (const SceneSettings& scene : scenes_) {
      const auto scores = scores_of(store, point, scene, kFirstPicture);
      if (!scores) {
        return;
      }
      cheap.push_back(*scores);
    }
    const double taken_s = process_cpu_s() - start;
    if (point.method.is_noisy && point.reduction > 1) {
      take_out_mean_errors(cheap, scores_);
    }
    MethodRanking row =
        worst_order(study_.goal, search_figures(study_.goal, cheap), figures_, errors_);
    row.label = point.label;
    row.cpu_s = taken_s / static_cast<double>(cheap.size());
    ranking.methods.push_back(row);
  }

  Clock::time_point start_ = Clock::now();
  const Study& study_;
  const Frontier& frontier_;
  const RankingOptions& options_;
  ThreadPool pool_;
  WantedScores wanted_;
  std::vector<SceneSettings> scenes_;
  std::vector<std::string> names_;            ///< of the goal's scores
  std::vector<Scores> scores_;                ///< of the reference, with standard errors
  std::vector<std::vector<double>> figures_;  ///< of each objective and design
  std::vector<std::vector<double>> errors_;   ///< their standard errors
};

}  // namespace

MethodRanking worst_order(const Goal& goal,
                          const std::vector<std::vector<double>>& cheap,
                          const std::vector<std::vector<double>>& reference,
                          const std::vector<std::vector<double>>& errors) {
  MethodRanking worst;
  const std::vector<Objective> objectives = objectives_of(goal);
  for (std::size_t k = 0; k < objectives.size(); ++k) {
    const RankAgreement agreement = rank_agreement(cheap[k], reference[k], errors[k]);
    const bool is_right = is_ranking_right(agreement);
    const bool is_worse =
        is_right == worst.is_right ? agreement.tau < worst.agreement.tau : worst.is_right;
    if (k == 0 || is_worse) {
      worst.score = objectives[k].name;
      worst.agreement = agreement;
      worst.is_right = is_right;
    }
  }
  return worst;
}

void take_out_mean_errors(std::span<Scores> cheap, std::span<const Scores> reference) {
  const auto number = static_cast<double>(cheap.size());
  Scores means;
  for (std::size_t i = 0; i < cheap.size(); ++i) {
    for (const auto& [name, value] : cheap[i]) {
      means[name] += (value - reference[i].at(name)) / number;
    }
  }
  for (Scores& scores : cheap) {
    for (auto& [name, value] : scores) {
      value -= means.at(name);
    }
  }
}

std::optional<DesignRanking> rank_designs(const Study& study,
                                          const Frontier& frontier,
                                          const RankingOptions& options) {
  if (!study.has_search() || !study.has_objective) {
    return std::nullopt;
  }
  return Ranking(study, frontier, options).run();
}

}  // namespace glint
