// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/search_race.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "metrics/statistics/told_value.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/search/final_race.h"
#include "studies/accuracy/outcome_labels.h"
#include "studies/front/front_designs.h"
#include "studies/run/repeated_scores.h"
#include "studies/run/results/judged_limits.h"
#include "studies/run/study_search.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// As objective_noise().
constexpr double kErrorsPerHalfWidth = 2.0;

constexpr const char* kKinds = "lighting_use";  // the choice among kinds of light

/// Who races, as the result names it.
struct NamedEntrant {
  Entrant entrant;
  std::string key;
  std::string title;
  SceneSettings scene;
};

/// The first repeated scans are the winner's own, which it must not be chosen by.
int scan_of_replicate(int replicate) {
  return kRepeatedScans + replicate;
}

int num_finalists(const Study& study, int evaluations) {
  return study.budget.race.value_or(study.search.is_noisy ? race_size(evaluations) : 0);
}

/// Without scores of its best there is no finalist.
bool has_finalist(const Study& study, const SearchResult& search) {
  return search.best && search.best->outcome && !search.best->outcome->is_failed &&
         problem_with(study.goal, search.best->outcome->scores).empty();
}

bool can_race(const Study& study) {
  return study.has_search() && study.has_objective && !has_several_objectives(study.goal);
}

/// Two scenes are one design only if nothing of them differs.
std::string design_key(const std::string& name, const SceneSettings& scene) {
  return name + " " + sha256_hex(to_toml(write_scene(scene)));
}

/// By rules 6 each kind of light has a finalist, where the search chooses among kinds.
std::optional<std::size_t> kinds_in_race(const Study& study, const SearchResult& search) {
  const std::vector<Variable>& variables = study.space.variables;
  const auto found = std::ranges::find(variables, kKinds, &Variable::name);
  return search.rules > 5 && found != variables.end()
             ? std::optional(static_cast<std::size_t>(found - variables.begin()))
             : std::nullopt;
}

/// Up to rounding, which counting steps from a variable's lower limit leaves, beside 0 as well.
bool is_same_value(const ConfigNode& a, const ConfigNode& b) {
  constexpr double kRounding = 1e-9;
  constexpr double kSmallest = 1e-3;
  if (a.is_number() && b.is_number()) {
    return std::abs(a.number - b.number) <=
           kRounding * std::max({std::abs(a.number), std::abs(b.number), kSmallest});
  }
  return a.kind == b.kind && a.boolean == b.boolean && a.text == b.text;
}

/// Whether a design is the baseline. A value of the file that its variable does not allow was moved
/// into the space for the search: that is another design.
bool is_baseline(const Study& study, const Point& point) {
  const Overrides values = overrides_of(study, point);
  return point == baseline_point(study) && std::ranges::all_of(values, [&](const auto& value) {
           return is_same_value(value.second, *study.resolved.at_path(value.first));
         });
}

std::vector<NamedEntrant> entrants_of(const Study& study,
                                      const std::vector<Trial>& trials,
                                      const SearchResult& search) {
  std::vector<NamedEntrant> all;
  bool has_baseline = false;
  for (const int number :
       finalists_of(study.goal,
                    study.space,
                    trials,
                    search.expected,
                    search.best->number,
                    {.count = static_cast<std::size_t>(num_finalists(study, search.evaluations)),
                    .kinds = kinds_in_race(study, search)},
                    search.limits)) {
    const Point& point = trials[static_cast<std::size_t>(number - 1)].point;
    has_baseline = has_baseline || is_baseline(study, point);
    all.push_back(
        {.entrant = {.key = fmt::format("trial {}", number), .trial = number, .point = point},
         .key = fmt::format("trial_{:03}", number),
         .title = fmt::format("Evaluation {}", number),
         .scene = scene_with(study, overrides_of(study, point))});
  }
  const auto add = [&](const std::string& key, const std::string& title, SceneSettings scene) {
    Entrant entrant{.key = design_key(key, scene)};
    all.push_back({std::move(entrant), key, title, std::move(scene)});
  };
  if (!has_baseline) {
    add("baseline", "Baseline", study.scene);
  }
  for (const Prototype& prototype : study.prototypes) {
    add(prototype.name, prototype.title, scene_with(study, prototype.overrides));
  }
  return all;
}

/// Also scores that noise does not change and those of trials, where the goal names them: without
/// them no replicate could be judged.
WantedScores wanted_in_race(const Study& study) {
  const WantedScores by_goal = wanted_by(study.goal);
  WantedScores wanted = wanted_of_repeats(study);
  wanted.coverage = by_goal.coverage;
  wanted.reach = by_goal.reach;
  wanted.lighting = by_goal.lighting;
  wanted.reference = by_goal.reference;
  wanted.trials = by_goal.trials;
  return wanted;
}

std::vector<double> values_of(const std::vector<Scores>& scans, const std::string& score) {
  std::vector<double> values;
  std::ranges::transform(
      scans, std::back_inserter(values), [&](const Scores& one) { return one.at(score); });
  return values;
}

/// Standard error of one evaluation, of what the score tells.
double told_error(const Objective& objective, const Scores& scores) {
  return objective_noise(objective, scores) / kErrorsPerHalfWidth;
}

/// The mean and its standard error, 0 of one value.
Expectation mean_with_error(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  Expectation found;
  for (const double value : values) {
    found.mean += value / count;
  }
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - found.mean) * (value - found.mean);
  }
  found.sd = values.size() > 1 ? std::sqrt(squares / (count * (count - 1.0))) : 0.0;
  return found;
}

/// Of the means of a racer's replicates, with their standard errors.
JudgedLimits limits_by_replicates(const Racer& racer, const Goal& goal) {
  JudgedLimits judged{.expected = {.probability = *racer.feasible_chance, .scores = {}},
                      .is_raced = true};
  for (const Constraint& constraint : goal.constraints) {
    judged.expected.scores.push_back(mean_with_error(values_of(racer.replicates, constraint.name)));
  }
  return judged;
}

std::optional<ModelledScore> expectation_of(const SearchResult& search, int trial) {
  const auto found = search.expected.find(trial);
  if (found == search.expected.end()) {
    return std::nullopt;
  }
  return ModelledScore{.mean = found->second.front().mean, .sd = found->second.front().sd};
}

void add_expectation(const std::optional<ModelledScore>& expected, Json& json) {
  if (expected) {
    json["expected"] = expected->mean;
    json["expected_sd"] = expected->sd;
  }
}

/// What the search knows of a finalist.
void add_searched(const Study& study, const SearchResult& search, const Trial& trial, Json& row) {
  row["trial"] = trial.number;
  row["variables"] = variables_json(study, trial.point);
  row["searched"] = trial.outcome->scores.at(study.goal.objective.name);
  add_expectation(expectation_of(search, trial.number), row);
}

void add_raced(const Study& study, const Racer& racer, double error, Json& row) {
  row["replicates"] = racer.replicates.size();
  if (racer.replicates.size() > 1) {
    const Estimate value =
        told_value(values_of(racer.replicates, study.goal.objective.name), error);
    row["value"] = value.value;
    row["low"] = value.low;
    row["high"] = value.high;
  }
  row["keeps_limits"] = racer.keeps_limits;
  if (racer.feasible_chance) {
    row["limits"] = limits_json(study.goal, limits_by_replicates(racer, study.goal));
  }
  row["given_up"] = racer.is_given_up;
  row["probability"] = racer.probability;
}

Json race_json(const Study& study,
               const std::vector<Trial>& trials,
               const SearchResult& search,
               const std::vector<NamedEntrant>& entrants,
               const FinalRace& race) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < entrants.size(); ++i) {
    const NamedEntrant& named = entrants[i];
    Json row = {{"key", i == race.best ? "winner" : named.key},
                {"title", i == race.best ? "Winner of the search" : named.title}};
    double error = 0.0;
    if (named.entrant.trial > 0) {
      const Trial& trial = trials[static_cast<std::size_t>(named.entrant.trial - 1)];
      error = told_error(study.goal.objective, trial.outcome->scores);
      add_searched(study, search, trial, row);
    }
    add_raced(study, race.racers[i], error, row);
    rows.push_back(std::move(row));
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Json& a, const Json& b) {
    return a["probability"].get<double>() > b["probability"].get<double>();
  });
  const auto num_finalists = std::ranges::count_if(
      entrants, [](const NamedEntrant& one) { return one.entrant.trial > 0; });
  return {{"finalists", num_finalists},
          {"replicates", kAllReplicates},
          {"evaluations", race.evaluations},
          {"searched", search.best->number},
          {"entrants", std::move(rows)}};
}

}  // namespace

bool has_race(const Study& study, const SearchResult& search) {
  return can_race(study) && has_finalist(study, search) && search.is_feasible &&
         num_finalists(study, search.evaluations) > 0;
}

int likely_replicates(const Study& study, int evaluations) {
  const int finalists = can_race(study) ? num_finalists(study, evaluations) : 0;
  auto others = static_cast<int>(study.prototypes.size());
  for (const Variable& variable : study.space.variables) {
    if (variable.name == kKinds) {  // at most one more of each kind but the best one's
      others += static_cast<int>(variable.choices.size()) - 1;
    }
  }
  return finalists > 0 ? kAllReplicates + kFirstReplicates * (finalists + others) : 0;
}

Scores replicate_scores(SceneStore& store,
                        const Study& study,
                        const SceneSettings& scene,
                        int replicate) {
  return repeated_scan(
      store, first_view(store, scene), wanted_in_race(study), scan_of_replicate(replicate));
}

Json race_finalists(SceneStore& store,
                    const Study& study,
                    Storage& storage,
                    SearchResult& search,
                    const std::atomic<int>* interrupt) {
  const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
  const std::vector<NamedEntrant> named = entrants_of(study, trials, search);
  std::vector<Entrant> entrants;
  std::ranges::transform(named, std::back_inserter(entrants), &NamedEntrant::entrant);
  const auto evaluate = [&](const Entrant& entrant, int replicate) {
    const auto index = static_cast<std::size_t>(
        std::ranges::find(entrants, entrant.key, &Entrant::key) - entrants.begin());
    return replicate_scores(store, study, named[index].scene, replicate);
  };
  const auto label = [&](const Entrant& /*entrant*/, int replicate) {
    return repeated_label(study.scene, scan_of_replicate(replicate));
  };
  const RaceLimits limits = search.rules > 7 ? RaceLimits::kByChance : RaceLimits::kByMeans;
  const std::optional<FinalRace> race =
      run_final_race(study.goal, entrants, storage, evaluate, interrupt, limits, label);
  if (!race) {
    return nullptr;
  }
  Json json = race_json(study, trials, search, named, *race);
  const int best = entrants[race->best].trial;
  search.best = trials[static_cast<std::size_t>(best - 1)];
  if (const Racer& winner = race->racers[race->best]; winner.feasible_chance) {
    search.is_feasible = winner.keeps_limits;
    search.judged_limits = limits_by_replicates(winner, study.goal);
  }
  Json chances = Json::array();
  for (const Json& row : json["entrants"]) {
    chances.push_back(
        {{"key", row["key"]}, {"title", row["title"]}, {"probability", row["probability"]}});
  }
  json["probability_best"] = std::move(chances);
  return json;
}

Json told_winner(const Study& study, const SearchResult& search, const Json& winner) {
  if (has_several_objectives(study.goal) || !study.has_objective) {
    return nullptr;
  }
  const Objective& objective = study.goal.objective;
  const Scores& seen = search.best->outcome->scores;
  const double error = told_error(objective, seen);
  const Json repeated = winner.value("repeated", Json::object());
  if (!repeated.contains(objective.name) || repeated[objective.name].size() < 2 ||
      (!study.search.is_noisy && error <= 0.0)) {
    return nullptr;
  }
  const auto scans = repeated[objective.name].get<std::vector<double>>();
  const std::optional<ModelledScore> expected = expectation_of(search, search.best->number);
  const Estimate value = told_value(scans, error, expected);
  Json told = {{"score", objective.name}, {"seen", seen.at(objective.name)}};
  add_expectation(expected, told);
  told["value"] = value.value;
  told["low"] = value.low;
  told["high"] = value.high;
  return told;
}

void add_race_to_result(
    const Study& study, const SearchResult& search, const Json& winner, Json& race, Json& result) {
  if (Json told = told_winner(study, search, winner); !told.is_null()) {
    result["best"]["told"] = std::move(told);
  }
  if (!race.is_null()) {
    result["probability_best"] = race["probability_best"];
    race.erase("probability_best");
    result["race"] = race;
  }
}

}  // namespace glint
