// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/run_winner.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/storage/storage.h"

namespace glint::stability {
namespace {

using RunJson = nlohmann::json;

constexpr int kSeeds = 5;
constexpr double kBlurStep_px = 0.1;
constexpr double kFirstFacets_mm = 0.5e-3;  ///< in place of an exact surface
constexpr double kFinerFacets = 0.8;        ///< of the study's own

int winner_of(const std::filesystem::path& run) {
  const RunJson result = RunJson::parse(read_file(run / "result.json"), nullptr, false);
  const bool has_best = result.is_object() && result.contains("best") &&
                        result["best"].is_object() && result["best"].contains("trial");
  if (!has_best) {
    throw ConfigError(run.string() + ": has no winner whose stability could be asked for");
  }
  return result["best"]["trial"].get<int>();
}

double largest_step(const SearchSpace& space, const Point& a, const Point& b) {
  const std::vector<double> one = unit_from_point(space, a);
  const std::vector<double> two = unit_from_point(space, b);
  double largest = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    largest = std::max(largest, std::abs(one[i] - two[i]));
  }
  return largest;
}

/// @param apart  of the winner in one variable at least
const Trial* best_beside(const Study& study,
                         const std::vector<Trial>& trials,
                         const Point& winner,
                         double apart) {
  const Trial* best = nullptr;
  for (const Trial& trial : trials) {
    const bool is_judged = trial.outcome && !trial.outcome->is_failed &&
                           problem_with(study.goal, trial.outcome->scores).empty();
    if (is_judged && trial.point != winner &&
        largest_step(study.space, trial.point, winner) >= apart &&
        (best == nullptr || is_better(study.goal, trial.outcome->scores, best->outcome->scores))) {
      best = &trial;
    }
  }
  return best;
}

/// What is changed for a cell.
struct Disturbance {
  double value = 0.0;  ///< as the cell tells it
  std::function<void(SceneSettings&)> put;
};

struct DisturbedSweep {
  Sweep sweep;
  std::vector<Disturbance> cells;  ///< the first one changes nothing
};

DisturbedSweep seeds_of(const SceneSettings& own) {
  DisturbedSweep found{.sweep = {.name = "winner_seed",
                                 .swept = "sensor.seed, render.paths.seed",
                                 .title = "winner and runner-up with other noise",
                                 .kind = Sweep::Kind::kWinner}};
  for (int k = 0; k < kSeeds; ++k) {
    found.cells.push_back({static_cast<double>(own.sensor.seed + k), [k](SceneSettings& scene) {
                             scene.sensor.seed += k;
                             scene.paths.seed += k;
                           }});
  }
  return found;
}

DisturbedSweep blurs_of(const SceneSettings& own) {
  DisturbedSweep found{.sweep = {.name = "winner_blur",
                                 .swept = "sensor.blur_px",
                                 .title = "winner and runner-up with more blur",
                                 .kind = Sweep::Kind::kWinner}};
  for (int k = 0; k < 3; ++k) {
    found.cells.push_back({own.sensor.blur_px + kBlurStep_px * k, [k](SceneSettings& scene) {
                             scene.sensor.blur_px += kBlurStep_px * k;
                           }});
  }
  return found;
}

DisturbedSweep facets_of(const SceneSettings& own) {
  DisturbedSweep found{.sweep = {.name = "winner_facets",
                                 .swept = "part.facets_um",
                                 .title = "winner and runner-up on other triangles",
                                 .kind = Sweep::Kind::kWinner}};
  const double facets_mm = own.part.facets_mm;
  const double other_mm = facets_mm > 0.0 ? kFinerFacets * facets_mm : kFirstFacets_mm;
  for (const double mm : {facets_mm, other_mm}) {
    found.cells.push_back({1e3 * mm, [mm](SceneSettings& scene) { scene.part.facets_mm = mm; }});
  }
  return found;
}

std::vector<DisturbedSweep> sweeps_of(const SceneSettings& own) {
  std::vector<DisturbedSweep> sweeps = {seeds_of(own), blurs_of(own)};
  if (own.part.shape != PartSettings::Shape::kMesh) {
    sweeps.push_back(facets_of(own));
  }
  for (DisturbedSweep& one : sweeps) {
    for (const Disturbance& cell : one.cells) {
      one.sweep.values.push_back({.value = cell.value});
    }
  }
  return sweeps;
}

/// Of both designs.
struct Lead {
  bool is_winners = true;  ///< by the study's goal, limits too
  double lead = 0.0;       ///< of the winner, > 0: better; in the score's unit
  double noise = 0.0;      ///< its standard error
  double winner = 0.0;     ///< its score
};

class WinnerMeasuring {
 public:
  WinnerMeasuring(const RunnersUp& run, const StabilityOptions& options)
      : run_(run), options_(options), pool_(options.threads), wanted_(wanted_by(run.study.goal)) {}

  Stability measure() {
    Stability stability{.bounds = options_.bounds};
    for (const DisturbedSweep& sweep : sweeps_of(run_.study.scene)) {
      stability.sweeps.push_back(measure(sweep));
    }
    return stability;
  }

 private:
  SweepResult measure(const DisturbedSweep& sweep) {
    SceneStore store(pool_);
    SweepResult result{.sweep = sweep.sweep};
    std::optional<Lead> undisturbed;
    for (const Disturbance& disturbance : sweep.cells) {
      if (options_.on_progress && !options_.on_progress(done_, sweep.sweep.name)) {
        break;
      }
      result.cells.push_back(cell_of(store, disturbance, undisturbed));
      ++done_;
    }
    return result;
  }

  Cell cell_of(SceneStore& store,
               const Disturbance& disturbance,
               std::optional<Lead>& undisturbed) const {
    Cell cell{.value = disturbance.value, .method = "own"};
    try {
      const Lead lead = lead_of(store, disturbance);
      undisturbed = undisturbed ? undisturbed : std::optional(lead);
      cell.errors = {error_of(*undisturbed, lead)};
      const CellError& error = cell.errors.front();
      cell.verdict = error.error <= error.bound ? Verdict::kRight : Verdict::kWrong;
      cell.message = fmt::format("{} of the winner {:.4g}, its lead {:.3g}",
                                 run_.study.goal.objective.name,
                                 lead.winner,
                                 lead.lead);
    } catch (const ConfigError& error) {
      cell.verdict = Verdict::kRefused;
      cell.message = error.what();
    }
    return cell;
  }

  Scores scores_of(SceneStore& store, const Disturbance& disturbance, const Point& point) const {
    SceneSettings scene = scene_with(run_.study, overrides_of(run_.study, point));
    disturbance.put(scene);
    return evaluate(store, scene, {}, wanted_).scores;
  }

  Lead lead_of(SceneStore& store, const Disturbance& disturbance) const {
    constexpr double kErrorsPerHalf = 2.0;  // as objective_noise()
    const Objective& objective = run_.study.goal.objective;
    const Scores winner = scores_of(store, disturbance, run_.winner);
    const Scores second = scores_of(store, disturbance, run_.second);
    const double difference = winner.at(objective.name) - second.at(objective.name);
    return {.is_winners = !is_better(run_.study.goal, second, winner),
            .lead = objective.is_maximised ? difference : -difference,
            .noise =
                std::hypot(objective_noise(objective, winner), objective_noise(objective, second)) /
                kErrorsPerHalf,
            .winner = winner.at(objective.name)};
  }

  /// Of h in points, of other scores in per cent of the winner's.
  CellError error_of(const Lead& before, const Lead& now) const {
    const bool is_h = run_.study.goal.objective.name.starts_with("homogeneity.h_");
    const double unit = is_h ? 0.01 : 0.01 * std::max(kMinContrast, std::abs(before.winner));
    const bool is_flipped = before.is_winners != now.is_winners;
    const double turned = std::min(std::abs(before.lead), std::abs(now.lead));
    const double own = is_h ? options_.bounds.h_points : options_.bounds.contrast_percent;
    return {.quantity = is_h ? "h_points" : "score_percent",
            .error = is_flipped ? turned / unit : 0.0,
            .bound = std::max(own, 2.0 * std::hypot(before.noise, now.noise) / unit),
            .measured = now.lead,
            .reference = before.lead};
  }

  const RunnersUp& run_;
  const StabilityOptions& options_;
  ThreadPool pool_;
  WantedScores wanted_;
  int done_ = 0;
};

}  // namespace

RunnersUp runners_up(const std::filesystem::path& run) {
  RunnersUp found{.study = load_study(run / "study.resolved.toml", {})};
  if (!found.study.has_search() || has_several_objectives(found.study.goal)) {
    throw ConfigError(run.string() + ": is no run that has searched by one objective");
  }
  found.winner_trial = winner_of(run);
  const std::vector<Trial> trials = Storage::read(run / "study.sqlite").trials(TrialKind::kSearch);
  const auto winner = std::ranges::find(trials, found.winner_trial, &Trial::number);
  if (winner == trials.end()) {
    throw IoError((run / "study.sqlite").string() + ": does not hold the winner");
  }
  found.winner = winner->point;
  const Trial* second = best_beside(found.study, trials, found.winner, kApart);
  second = second != nullptr ? second : best_beside(found.study, trials, found.winner, 0.0);
  if (second == nullptr) {
    throw ConfigError(run.string() + ": has one design, which nothing can be better than");
  }
  found.second = second->point;
  found.second_trial = second->number;
  return found;
}

int count_winner_cells(const RunnersUp& run) {
  std::vector<Sweep> sweeps;
  for (const DisturbedSweep& one : sweeps_of(run.study.scene)) {
    sweeps.push_back(one.sweep);
  }
  return count_cells(sweeps);
}

Stability measure_winner(const RunnersUp& run, const StabilityOptions& options) {
  return WinnerMeasuring(run, options).measure();
}

}  // namespace glint::stability
