// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/rescored_designs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/config/config.h"
#include "core/error.h"
#include "core/file.h"
#include "core/log.h"
#include "core/text.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/storage/storage.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/definition/scene_file.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/scene_picture.h"
#include "studies/validate/common_exposure.h"
#include "studies/validate/validate_result.h"
#include "studies/validate/validated_scene.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// What a design is chosen by.
struct Score {
  std::optional<double> objective;  ///< empty: it cannot be scored
  bool is_feasible = false;
  double error = 0.0;  ///< standard error of the objective by rendering
};

/// Empty: it cannot be scored.
Scores scores_of(SceneStore& store, const SceneSettings& scene, const Goal& goal) {
  try {
    return evaluate(store, first_view(store, scene), {}, wanted_by(goal)).scores;
  } catch (const ConfigError& error) {
    log(LogLevel::kWarning, "a design cannot be scored again: {}", error.what());
    return {};
  }
}

Score objective_score(const Scores& scores, const Goal& goal, const Objective& objective) {
  const auto found = scores.find(objective.name);
  if (found == scores.end()) {
    return {};
  }
  const auto error = scores.find(objective.name + ".error");
  return {.objective = found->second,
          .is_feasible = is_feasible(goal, scores),
          .error = error == scores.end() ? 0.0 : error->second};
}

Json json_of(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// As a search: one that meets the limits before one that does not, one that has no score last.
bool is_better(const Score& one, const Score& other, bool is_maximised) {
  if (!one.objective || !other.objective) {
    return one.objective.has_value() && !other.objective;
  }
  if (one.is_feasible != other.is_feasible) {
    return one.is_feasible;
  }
  return is_maximised ? *one.objective > *other.objective : *one.objective < *other.objective;
}

constexpr double kToldErrors = 2.0;  ///< combined ones: less is noise of rendering

/// Whether one is better by more than rendering may have made it.
bool is_surely_better(const Score& one, const Score& other, bool is_maximised) {
  if (!is_better(one, other, is_maximised)) {
    return false;
  }
  const bool is_by_value = one.objective && other.objective && one.is_feasible == other.is_feasible;
  return !is_by_value || std::abs(*one.objective - *other.objective) >
                             kToldErrors * std::hypot(one.error, other.error);
}

constexpr std::size_t kTrials = 20;  ///< best of the search
constexpr const char* kWinnersFolder = "winner";

struct RescoredDesign {
  std::string name;
  bool is_trial = false;  ///< of the search, without a folder of its own
  SceneSettings scene;
  Scores scores_before = {};
  Scores scores_after = {};
  Score before = {};  ///< by the objective that is looked at
  Score after = {};
};

void look_at(const Objective& objective, const Goal& goal, std::vector<RescoredDesign>& designs) {
  for (RescoredDesign& design : designs) {
    design.before = objective_score(design.scores_before, goal, objective);
    design.after = objective_score(design.scores_after, goal, objective);
  }
}

std::string text_of(const SceneSettings& scene) {
  return to_toml(write_scene(scene));
}

/// All search trials that have an objective, the best first.
std::vector<Trial> ranked_trials(const std::filesystem::path& database, const Goal& goal) {
  std::vector<Trial> trials = Storage::read(database).trials(TrialKind::kSearch);
  const std::string& name = goal.objective.name;
  std::erase_if(trials, [&name](const Trial& trial) {
    return !trial.outcome || trial.outcome->is_failed || !trial.outcome->scores.contains(name);
  });
  const auto score = [&goal](const Trial& trial) {
    return objective_score(trial.outcome->scores, goal, goal.objective);
  };
  std::ranges::stable_sort(trials, [&](const Trial& one, const Trial& other) {
    return is_better(score(one), score(other), goal.objective.is_maximised);
  });
  return trials;
}

/// Adds the best trials of a search by one objective, but for those there by another name.
void add_trials(const Study& study,
                const std::filesystem::path& run,
                std::vector<RescoredDesign>& designs) {
  const std::filesystem::path database = run / "study.sqlite";
  if (!study.has_search() || has_several_objectives(study.goal) || !is_there(database)) {
    return;
  }
  std::set<std::string> known;
  for (const RescoredDesign& design : designs) {
    known.insert(text_of(design.scene));
  }
  std::size_t added = 0;
  try {
    for (const Trial& trial : ranked_trials(database, study.goal)) {
      if (added == kTrials) {
        break;
      }
      SceneSettings scene = scene_with(study, overrides_of(study, trial.point));
      if (known.insert(text_of(scene)).second) {
        designs.push_back({.name = fmt::format("trial {}", trial.number),
                           .is_trial = true,
                           .scene = std::move(scene)});
        ++added;
      }
    }
  } catch (const Error& error) {
    log(LogLevel::kWarning, "trials of the search cannot be scored again: {}", error.what());
  }
}

/// Names, the best first; those without a score are not among them.
std::vector<std::string> order_of(const std::vector<RescoredDesign>& designs,
                                  Score RescoredDesign::*score,
                                  bool is_maximised) {
  std::vector<const RescoredDesign*> sorted;
  for (const RescoredDesign& design : designs) {
    if ((design.*score).objective) {
      sorted.push_back(&design);
    }
  }
  std::ranges::stable_sort(sorted, [&](const RescoredDesign* one, const RescoredDesign* other) {
    return is_better(one->*score, other->*score, is_maximised);
  });
  std::vector<std::string> names;
  std::ranges::transform(sorted, std::back_inserter(names), &RescoredDesign::name);
  return names;
}

/// The run's winner, where it is among them, else the best before the refit; null: none is scored.
const RescoredDesign* winner_of(const std::vector<RescoredDesign>& designs,
                                const std::vector<std::string>& order) {
  const auto has_name = [&designs](const std::string& name) {
    return std::ranges::find(designs, name, &RescoredDesign::name);
  };
  const auto winner = has_name(kWinnersFolder);
  if (winner != designs.end() && winner->before.objective) {
    return &*winner;
  }
  return order.empty() ? nullptr : &*has_name(order.front());
}

/// Who takes the winner's place.
struct Challenge {
  const RescoredDesign* challenger = nullptr;  ///< null: none surely does
  const RescoredDesign* untold = nullptr;      ///< is ahead by no more than noise
};

/// The best of those that the refit lifts above the winner. Trials that noise alone had above it
/// before, and has so still, are none.
Challenge challenge_to(const std::vector<RescoredDesign>& designs,
                       const RescoredDesign& winner,
                       bool is_maximised) {
  Challenge found;
  for (const RescoredDesign& design : designs) {
    const bool is_lifted = is_better(design.after, winner.after, is_maximised) &&
                           !is_better(design.before, winner.before, is_maximised);
    if (!is_lifted) {
      continue;
    }
    const RescoredDesign*& best = is_surely_better(design.after, winner.after, is_maximised)
                                      ? found.challenger
                                      : found.untold;
    if (best == nullptr || is_better(design.after, best->after, is_maximised)) {
      best = &design;
    }
  }
  return found;
}

Json row_of(const RescoredDesign& design) {
  return {{"name", design.name},
          {"of", design.is_trial ? "search" : "run"},
          {"before", json_of(design.before.objective)},
          {"after", json_of(design.after.objective)},
          {"error_before", design.before.error},
          {"error_after", design.after.error},
          {"feasible_before", design.before.is_feasible},
          {"feasible_after", design.after.is_feasible}};
}

Json rows_of(const std::vector<RescoredDesign>& designs) {
  Json rows = Json::array();
  std::ranges::transform(designs, std::back_inserter(rows), row_of);
  return rows;
}

std::string winner_text(const Json& rescored) {
  const std::string winner = rescored["winner_before"].get<std::string>();
  if (rescored["changed"].is_null()) {
    return fmt::format(
        "whether {} takes the place of {} cannot be told: they differ by less than two standard "
        "errors of rendering",
        rescored["untold"].get<std::string>(),
        winner);
  }
  if (rescored["changed"].get<bool>()) {
    return fmt::format(
        "{} takes the place of {}", rescored["winner_after"].get<std::string>(), winner);
  }
  const bool is_first = rescored["order_after"][0] == winner;
  return winner + " stays the winner" +
         (is_first ? "" : ": what is ahead of it was so without the refit, too");
}

/// "... the order by homogeneity.h_rms is ring, trial 7, dome and 20 more; ring stays the winner."
std::string order_text(const Json& rescored) {
  constexpr std::size_t kTold = 5;
  std::vector<std::string> names = rescored["order_after"].get<std::vector<std::string>>();
  const std::size_t all = names.size();
  names.resize(std::min(all, kTold));
  return fmt::format("With what the refit has found, the order by {} is {}{}; {}.",
                     rescored["objective"].get<std::string>(),
                     join(names, ", "),
                     all > kTold ? fmt::format(" and {} more", all - kTold) : "",
                     winner_text(rescored));
}

/// Whether the refit surely puts a design before one that was not behind it.
bool has_other_order(const std::vector<RescoredDesign>& designs, bool is_maximised) {
  return std::ranges::any_of(designs, [&](const RescoredDesign& one) {
    return std::ranges::any_of(designs, [&](const RescoredDesign& other) {
      return is_surely_better(one.after, other.after, is_maximised) &&
             !is_better(one.before, other.before, is_maximised);
    });
  });
}

/// Several objectives have no winner in common: the order by each.
Json orders_json(const Goal& goal, std::vector<RescoredDesign>& designs) {
  Json objectives = Json::array();
  std::vector<std::string> told;
  for (const Objective& objective : objectives_of(goal)) {
    look_at(objective, goal, designs);
    const auto before = order_of(designs, &RescoredDesign::before, objective.is_maximised);
    const auto after = order_of(designs, &RescoredDesign::after, objective.is_maximised);
    const bool is_changed = has_other_order(designs, objective.is_maximised);
    const char* const how = is_changed ? "is another" : "holds as far as it can be decided";
    if (!after.empty()) {
      told.push_back(fmt::format("by {} {} ({})", objective.name, how, join(after, ", ")));
    }
    objectives.push_back({{"objective", objective.name},
                          {"designs", rows_of(designs)},
                          {"order_before", before},
                          {"order_after", after},
                          {"changed", is_changed}});
  }
  const std::string text = "With what the refit has found, the order " + join(told, ", ") + ".";
  return {{"objectives", objectives}, {"text", told.empty() ? "" : text}};
}

bool has_moved(const RigidTransform& motion) {
  return !motion.rotation.isIdentity(0.0) || !motion.translation_mm.isZero(0.0);
}

/// Of the pictures that the cell takes at the exposure of the design, which is found without the
/// refit. Empty: it cannot be scored.
Scores scores_after(SceneStore& store,
                    const RescoredDesign& design,
                    const DesignRefit& refit,
                    const Goal& goal) {
  try {
    const SceneSettings exposed = with_equal_exposure(store, design.scene);
    return scores_of(store, refitted_scene(store, exposed, refit, design.name), goal);
  } catch (const ConfigError&) {  // why it has no exposure is told by the score before the refit
    return {};
  }
}

Json rescored_json(const Study& study, const std::vector<RescoredDesign>& designs) {
  const bool is_maximised = study.goal.objective.is_maximised;
  const auto before = order_of(designs, &RescoredDesign::before, is_maximised);
  const auto after = order_of(designs, &RescoredDesign::after, is_maximised);
  const RescoredDesign* const winner = winner_of(designs, before);
  const Challenge challenge =
      winner == nullptr ? Challenge{} : challenge_to(designs, *winner, is_maximised);
  const RescoredDesign* const challenger = challenge.challenger;
  const bool is_untold = challenger == nullptr && challenge.untold != nullptr;
  const std::string name = winner == nullptr ? "" : winner->name;
  Json json = {{"objective", study.goal.objective.name},
               {"designs", rows_of(designs)},
               {"order_before", before},
               {"order_after", after},
               {"winner_before", name},
               {"winner_after", challenger == nullptr ? name : challenger->name}};
  json["changed"] = is_untold ? Json(nullptr) : Json(challenger != nullptr);
  json["untold"] = is_untold ? Json(challenge.untold->name) : Json(nullptr);
  json["text"] = winner == nullptr || after.empty() ? "" : order_text(json);
  return json;
}

}  // namespace

DesignRefit refit_of(const ValidationFindings& findings, const GeometryBudget& budget) {
  DesignRefit refit = {.change = common_change(findings)};
  const GeometryFit& geometry = findings.geometry;
  if (std::ranges::find(geometry.faults, GeometryFault::kPartPose) != geometry.faults.end()) {
    refit.scene_from_part = moved_by(geometry.part);
    refit.scene_from_part.translation_mm +=
        budget.middle_mm - refit.scene_from_part.rotation * budget.middle_mm;
  }
  if (const GreyFit* cell = validate_detail::common_fit(findings.grey)) {
    for (const DesignGrey& grey : findings.grey) {
      if (grey.fit.is_known && validate_detail::has_other_power(grey.fit, *cell)) {
        refit.exposures[grey.design] = grey.fit.change.exposure;
      }
    }
  }
  return refit;
}

SceneSettings refitted_scene(SceneStore& store,
                             const SceneSettings& scene,
                             const DesignRefit& refit,
                             const std::string& design) {
  SceneChange change = refit.change;
  if (const auto own = refit.exposures.find(design); own != refit.exposures.end()) {
    change.exposure = own->second;
  }
  SceneSettings changed = changed_scene(scene, change);
  if (has_moved(refit.scene_from_part)) {
    changed = first_view(store, std::move(changed));
  }
  // The part stays in the scene's frame, which everything else is told in: the camera moves.
  for (Viewpoint& viewpoint : changed.viewpoints) {
    viewpoint = viewpoint_of_pose(camera_from_world(viewpoint) * refit.scene_from_part);
  }
  return changed;
}

Json rescore_designs(SceneStore& store,
                     const Study& study,
                     const std::filesystem::path& run,
                     const std::vector<std::string>& names,
                     const DesignRefit& refit) {
  if (!study.has_objective) {
    return nullptr;
  }
  std::vector<RescoredDesign> designs;
  for (const std::string& name : names) {
    designs.push_back({.name = name, .scene = load_scene(run / name / "scene.toml")});
  }
  add_trials(study, run, designs);
  for (RescoredDesign& design : designs) {
    design.scores_before = scores_of(store, design.scene, study.goal);
    design.scores_after = scores_after(store, design, refit, study.goal);
  }
  if (has_several_objectives(study.goal)) {
    return orders_json(study.goal, designs);
  }
  look_at(study.goal.objective, study.goal, designs);
  return rescored_json(study, designs);
}

}  // namespace glint
