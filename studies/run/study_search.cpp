// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/study_search.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "metrics/scores.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/front/choice_cost.h"
#include "optimizer/search/trade_off.h"
#include "studies/accuracy/chosen_accuracy.h"
#include "studies/evaluation/exact_lighting.h"
#include "studies/front/front_designs.h"
#include "studies/imaging/searched/searched_scene.h"
#include "studies/run/design_files.h"
#include "studies/run/repeated_scores.h"
#include "studies/run/results/judged_limits.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kErrorsPerHalf = 2.0;  // as objective_noise()
constexpr std::size_t kNoisePlaces = 24;

/// Of the objectives that noise moves. @param row  one number an objective
Json expected_json(const Study& study,
                   const Trial& trial,
                   const std::vector<Expectation>& row,
                   const std::vector<std::string>& exact) {
  Json expected = Json::object();
  const std::vector<Objective> objectives = objectives_of(study.goal);
  for (std::size_t k = 0; k < objectives.size(); ++k) {
    const std::string& name = objectives[k].name;
    const bool is_noisy = study.search.is_noisy && std::ranges::find(exact, name) == exact.end();
    if (is_noisy || objective_noise(objectives[k], trial.outcome->scores) > 0.0) {
      expected[name] = {{"value", row[k].mean}, {"sd", row[k].sd}};
    }
  }
  return expected;
}

Json design_of_front(const Study& study, const Trial& trial) {
  const Scores& known = trial.outcome->scores;
  Json scores = Json::object();
  Json errors = Json::object();
  for (const Objective& objective : objectives_of(study.goal)) {
    scores[objective.name] = known.at(objective.name);
    if (const double noise = objective_noise(objective, known); noise > 0.0) {
      errors[objective.name] = noise / kErrorsPerHalf;
    }
  }
  for (const Constraint& constraint : study.goal.constraints) {
    scores[constraint.name] = known.at(constraint.name);
  }
  return {{"trial", trial.number},
          {"variables", variables_json(study, trial.point)},
          {"scores", scores},
          {"errors", errors}};
}

/// What a search under noise has its front of, beside what was seen. @param row  one an objective
void take_expected(const Study& study, const std::vector<Expectation>& row, Json& design) {
  Json searched = Json::object();
  const std::vector<Objective> objectives = objectives_of(study.goal);
  for (std::size_t k = 0; k < objectives.size(); ++k) {
    Json& score = design["scores"][objectives[k].name];
    searched[objectives[k].name] = score;
    score = row[k].mean;
  }
  design["searched"] = std::move(searched);
}

/// [evaluations, half the interval of the hypervolume] at some places, the last one among them:
/// each costs a hypervolume for every number of the front.
Json noise_history(const Study& study,
                   const std::vector<Trial>& trials,
                   const std::vector<double>& reference,
                   const SearchResult& search) {
  const Expectations of_front = search.of_front();
  std::vector<Trial> done;
  std::ranges::copy_if(trials, std::back_inserter(done), [](const Trial& trial) {
    return trial.outcome.has_value();
  });
  std::set<std::size_t> places;
  for (std::size_t k = 1; k <= kNoisePlaces; ++k) {
    places.insert(k * done.size() / kNoisePlaces);
  }
  Json list = Json::array();
  for (const std::size_t place : places) {
    const auto first = std::span<const Trial>(done).first(place);
    list.push_back({place, trade_off(study.goal, first, reference, of_front, search.limits).noise});
  }
  return list;
}

/// Limited scores of which an evaluation tells all, though a design alone does not tell them.
std::vector<std::string> steady_limits(const Goal& goal) {
  std::vector<std::string> names;
  for (const Constraint& constraint : goal.constraints) {
    if (is_of_coverage(constraint.name) || is_of_reach(constraint.name)) {
      names.push_back(constraint.name);
    }
  }
  return names;
}

/// What a search knows beside its trials.
struct Judged {
  const Expectations& expected;
  int winner = 0;
  const LimitExpectations& limits;
  FreshOutcomes* fresh = nullptr;  ///< gets what is rescored
};

/// The best of some trials; of several objectives the compromise of their front.
const Trial* best_of(const Study& study,
                     const std::vector<Trial>& trials,
                     const std::optional<TradeOff>& front,
                     const Judged& judged) {
  if (front && !front->trials.empty()) {
    return &*std::ranges::find(trials, front->trials[front->chosen], &Trial::number);
  }
  const std::vector<int> feasible = front ? std::vector<int>{}
                                          : finalists_of(study.goal,
                                                         study.space,
                                                         trials,
                                                         judged.expected,
                                                         judged.winner,
                                                         {.count = 1},
                                                         judged.limits);
  if (!feasible.empty()) {
    return &*std::ranges::find(trials, feasible.front(), &Trial::number);
  }
  const std::optional<Trial> best = most_likely_feasible(study.goal, trials, judged.limits);
  return best ? &*std::ranges::find(trials, best->number, &Trial::number) : nullptr;
}

/// Those that succeeded with that value of a variable.
std::vector<Trial> trials_with(const Study& study,
                               const std::vector<Trial>& trials,
                               std::size_t variable,
                               double value) {
  std::vector<Trial> of_kind;
  std::ranges::copy_if(trials, std::back_inserter(of_kind), [&](const Trial& trial) {
    return trial.outcome && !trial.outcome->is_failed && trial.point[variable] == value &&
           problem_with(study.goal, trial.outcome->scores).empty();
  });
  return of_kind;
}

struct KindFinalist {
  std::string kind;
  Trial trial;
  Scores fresh;
  std::optional<TradeOff> front = {};  ///< of the kind's trials, with several objectives
  int on_front = 0;                    ///< of the whole front's designs
};

/// Without a value: nothing of the kind was evaluated or could be rescored.
std::optional<KindFinalist> finalist_of(SceneStore& store,
                                        const Study& study,
                                        const std::vector<Trial>& of_kind,
                                        const std::vector<double>& reference,
                                        const Judged& judged) {
  KindFinalist finalist;
  if (has_several_objectives(study.goal)) {
    finalist.front = trade_off(study.goal, of_kind, reference, judged.expected, judged.limits);
  }
  const Trial* best = best_of(study, of_kind, finalist.front, judged);
  std::optional<Scores> fresh =
      best != nullptr ? rescored_trial(store, study, *best, judged.fresh) : std::optional<Scores>();
  if (!fresh) {
    return std::nullopt;
  }
  finalist.trial = *best;
  finalist.fresh = *std::move(fresh);
  return finalist;
}

/// One objective: the best first. Several: feasible ones by what the choice takes, one after the
/// other, in the ranges of all of them.
void sort_kinds(const Goal& goal, std::vector<KindFinalist>& finalists) {
  if (!has_several_objectives(goal) || finalists.empty()) {
    std::ranges::stable_sort(finalists, [&](const KindFinalist& a, const KindFinalist& b) {
      return is_better(goal, a.fresh, b.fresh);
    });
    return;
  }
  std::vector<std::vector<double>> rows;
  std::ranges::transform(finalists, std::back_inserter(rows), [&](const KindFinalist& one) {
    return minimised_objectives(goal, one.fresh);
  });
  const std::vector<ObjectiveRange> ranges = objective_ranges(rows);
  const FrontChoice choice = front_choice_of(goal);
  std::ranges::stable_sort(finalists, {}, [&](const KindFinalist& one) {
    return std::pair(violation(goal, one.fresh),
                     choice_order(minimised_objectives(goal, one.fresh), ranges, choice));
  });
}

Json kind_json(const Study& study, const KindFinalist& finalist) {
  Json json = {{"lighting_use", finalist.kind},
               {"trial", finalist.trial.number},
               {"variables", variables_json(study, finalist.trial.point)},
               {"scores", scores_json(finalist.trial.outcome->scores)},
               {"rescored", scores_json(finalist.fresh)},
               {"feasible", is_feasible(study.goal, finalist.fresh)}};
  if (finalist.front) {
    json["hypervolume"] = finalist.front->hypervolume;
    json["on_front"] = finalist.on_front;
  }
  return json;
}

/// Of the whole front's designs, by that variable's value.
int count_on_front(const TradeOff& front,
                   const std::vector<Trial>& trials,
                   std::size_t variable,
                   double value) {
  return static_cast<int>(std::ranges::count_if(front.trials, [&](int number) {
    return trials[static_cast<std::size_t>(number - 1)].point[variable] == value;
  }));
}

/// Those that could be rescored, in the order of the choices. @param use  index of lighting_use
std::vector<KindFinalist> kind_finalists(SceneStore& store,
                                         const Study& study,
                                         const std::vector<Trial>& trials,
                                         std::size_t use,
                                         const std::vector<double>& reference,
                                         const Judged& judged) {
  const bool is_front = has_several_objectives(study.goal);
  const TradeOff whole =
      is_front ? trade_off(study.goal, trials, reference, judged.expected, judged.limits)
               : TradeOff{};
  const std::vector<std::string>& choices = study.space.variables[use].choices;
  std::vector<KindFinalist> finalists;
  for (std::size_t kind = 0; kind < choices.size(); ++kind) {
    const auto value = static_cast<double>(kind);
    const std::vector<Trial> of_kind = trials_with(study, trials, use, value);
    if (auto finalist = finalist_of(store, study, of_kind, whole.reference, judged)) {
      finalist->kind = choices[kind];
      finalist->on_front = count_on_front(whole, trials, use, value);
      finalists.push_back(*std::move(finalist));
    }
  }
  return finalists;
}

/// What best_of_each_kind() gives.
Json rescored_kinds(SceneStore& store,
                    const Study& study,
                    const std::vector<Trial>& trials,
                    const std::vector<double>& reference,
                    const Judged& judged) {
  const std::vector<Variable>& variables = study.space.variables;
  const auto found = std::ranges::find(variables, "lighting_use", &Variable::name);
  if (found == variables.end()) {
    return nullptr;
  }
  const auto use = static_cast<std::size_t>(found - variables.begin());
  std::vector<KindFinalist> finalists =
      kind_finalists(store, study, trials, use, reference, judged);
  sort_kinds(study.goal, finalists);
  Json kinds = Json::array();
  std::ranges::transform(finalists, std::back_inserter(kinds), [&](const KindFinalist& finalist) {
    return kind_json(study, finalist);
  });
  return kinds;
}

}  // namespace

Json variables_json(const Study& study, const Point& point) {
  Json json = Json::object();
  for (const auto& [path, value] : overrides_of(study, point)) {
    switch (value.kind) {
      case ConfigNode::Kind::kBoolean:
        json[path] = value.boolean;
        break;
      case ConfigNode::Kind::kInteger:
        json[path] = value.integer;
        break;
      case ConfigNode::Kind::kNumber:
        json[path] = value.number;
        break;
      default:
        json[path] = value.text;
    }
  }
  return json;
}

Json baseline_variables_json(const Study& study) {
  Json json = Json::object();
  for (const Variable& variable : study.space.variables) {
    const ConfigNode& node = *study.resolved.at_path(variable.name);
    if (node.is_number()) {
      json[variable.name] = node.number;
    } else if (node.kind == ConfigNode::Kind::kBoolean) {
      json[variable.name] = node.boolean;
    } else {
      json[variable.name] = node.text;
    }
  }
  return json;
}

Json front_json(const Study& study, const Storage& storage, const SearchResult& search) {
  const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
  const Expectations of_front = search.of_front();
  const TradeOff found =
      trade_off(study.goal, trials, recorded_reference(storage.events()), of_front, search.limits);
  const std::vector<double> reference = in_score_units(study.goal, found.reference);
  const std::vector<Objective> objectives = objectives_of(study.goal);
  Json json = {{"objectives", Json::array()}, {"designs", Json::array()}};
  Json at = Json::object();
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    const Json value = reference.empty() ? Json(nullptr) : Json(reference[i]);
    json["objectives"].push_back(
        {{"score", objectives[i].name},
         {"direction", objectives[i].is_maximised ? "maximise" : "minimise"},
         {"reference", value}});
    at[objectives[i].name] = value;
  }
  const std::vector<std::string> exact = exact_lighting(study).names;
  for (const int number : found.trials) {
    const Trial& trial = trials[static_cast<std::size_t>(number - 1)];
    json["designs"].push_back(design_of_front(study, trial));
    if (const auto known = search.limits.find(number); known != search.limits.end()) {
      json["designs"].back()["limits"] = limits_json(study.goal, {.expected = known->second});
    }
    const auto row = search.expected.find(number);
    if (row == search.expected.end()) {
      continue;
    }
    json["designs"].back()["expected"] = expected_json(study, trial, row->second, exact);
    if (found.is_expected) {
      take_expected(study, row->second, json["designs"].back());
    }
  }
  json["hypervolume"] = found.hypervolume;
  json["noise"] = found.noise;
  json["history"] =
      hypervolume_history(study.goal, trials, found.reference, of_front, search.limits);
  json["noise_history"] = noise_history(study, trials, found.reference, search);
  json["reference"] = at;
  json["outside"] = found.outside;
  json["chosen"] = nullptr;
  if (!found.trials.empty()) {
    json["chosen"] = {{"trial", found.trials[found.chosen]},
                      {"by", choice_rule_name(study.goal.choice)},
                      {"reason", found.reason}};
  }
  if (found.is_expected) {
    json["is_expected"] = true;
  }
  if (!search.limits.empty()) {
    json["is_likely"] = true;
  }
  plan_front(study.goal, json);
  return json;
}

SearchTask search_task(const Study& study, int jobs) {
  return {.space = study.space,
          .settings = study.search,
          .goal = study.goal,
          .budget = study.budget,
          .start_points = {baseline_point(study)},
          .jobs = jobs,
          .exact = exact_lighting(study),
          .steady = steady_limits(study.goal)};
}

WantedScores wanted_in_search(const Study& study) {
  WantedScores wanted = wanted_in_trial(study);
  if (wants_derivatives(study)) {
    wanted.gradients = wanted_with_gradients(study.goal, study.space).gradients;
  }
  return wanted;
}

Outcome evaluate_candidate(SceneStore& store,
                           const Study& study,
                           const Point& point,
                           const RenderRung* rung) {
  const std::filesystem::path& file = study.scene.part.file;
  if (!file.empty() && !std::filesystem::exists(file)) {
    throw IoError(file.string() + ": has gone while the study was running");
  }
  const SceneSettings own = scene_with(study, overrides_of(study, point));
  const WantedScores wanted = wanted_in_search(study);
  const SceneSettings scene =
      rung != nullptr ? searched_scene(store, own, *rung, wanted.trials) : own;
  Evaluation found = evaluate(store, scene, {}, wanted);
  Outcome outcome;
  outcome.scores = std::move(found.scores);
  if (rung != nullptr) {
    less_offsets(own, scene, *rung, outcome.scores);
  }
  outcome.gradients = std::move(found.gradients.by_score);
  outcome.remarks = std::move(found.gradients.remarks);
  return outcome;
}

Json best_of_each_kind(SceneStore& store,
                       const Study& study,
                       const std::vector<Trial>& trials,
                       const std::vector<double>& reference,
                       const Expectations& expected,
                       int winner,
                       const LimitExpectations& limits) {
  return rescored_kinds(
      store, study, trials, reference, {.expected = expected, .winner = winner, .limits = limits});
}

Json kinds_of_search(SceneStore& store,
                     const Study& study,
                     const Storage& storage,
                     const SearchResult& search,
                     FreshOutcomes* fresh) {
  return rescored_kinds(store,
                        study,
                        storage.trials(TrialKind::kSearch),
                        recorded_reference(storage.events()),
                        {.expected = has_several_objectives(study.goal) ? search.of_front()
                                     : study.search.is_noisy            ? search.expected
                                                                        : Expectations{},
                         .winner = search.best->number,
                         .limits = search.limits,
                         .fresh = fresh});
}

}  // namespace glint
