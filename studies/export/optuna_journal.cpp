// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/export/optuna_journal.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/storage/storage.h"
#include "studies/definition/study.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kWriter = "glint";
constexpr int kCreateStudy = 0;
constexpr int kCreateTrial = 4;
constexpr int kComplete = 1;
constexpr int kFail = 3;
constexpr int kMinimise = 1;
constexpr int kMaximise = 2;
constexpr double kFarBeyond = 1e300;  // stands for infinity, which JSON has not

/// Optuna knows no logarithmic numbers with a step: they are told as plain ones.
Json distribution_of(const Variable& variable) {
  const bool has_step = variable.step > 0.0;
  const double last =
      has_step ? variable.low + variable.step * (num_values(variable) - 1.0) : variable.high;
  switch (variable.kind) {
    case Variable::Kind::kChoice:
      return {{"name", "CategoricalDistribution"}, {"attributes", {{"choices", variable.choices}}}};
    case Variable::Kind::kInteger: {
      const bool is_plain = variable.step <= 1.0;
      return {{"name", "IntDistribution"},
              {"attributes",
               {{"log", variable.is_log && is_plain},
                {"step", is_plain ? 1 : std::llround(variable.step)},
                {"low", std::llround(variable.low)},
                {"high", std::llround(last)}}}};
    }
    case Variable::Kind::kFloat:
      break;
  }
  return {{"name", "FloatDistribution"},
          {"attributes",
           {{"step", has_step ? Json(variable.step) : Json(nullptr)},
            {"low", variable.low},
            {"high", last},
            {"log", variable.is_log && !has_step}}}};
}

/// How far each limited score is beyond its limit.
Json violations_of(const Goal& goal, const Scores& scores) {
  Json beyond = Json::array();
  for (const Constraint& constraint : goal.constraints) {
    const auto found = scores.find(constraint.name);
    const double value =
        found == scores.end() ? 0.0 : std::clamp(found->second, -kFarBeyond, kFarBeyond);
    if (constraint.min) {
      beyond.push_back(*constraint.min - value);
    }
    if (constraint.max) {
      beyond.push_back(value - *constraint.max);
    }
  }
  return beyond;
}

/// As the search judges: without one of the scores that it needs a trial has failed.
bool is_complete(const Goal& goal, const Outcome& outcome) {
  return !outcome.is_failed && problem_with(goal, outcome.scores).empty();
}

std::string time_text(double seconds) {
  const auto micros = static_cast<std::int64_t>(std::llround(seconds * 1e6));
  const std::chrono::sys_seconds whole{std::chrono::seconds(micros / 1000000)};
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:06d}", whole, micros % 1000000);
}

/// The variables that are active at the trial's point.
void add_parameters(const SearchSpace& space, const Point& point, Json& line) {
  Json distributions = Json::object();
  Json parameters = Json::object();
  for (std::size_t i = 0; i < space.variables.size(); ++i) {
    const Variable& variable = space.variables[i];
    if (is_active(space, point, i)) {
      distributions[variable.name] = distribution_of(variable).dump();
      parameters[variable.name] = point[i];
    }
  }
  line["distributions"] = distributions;
  line["params"] = parameters;
}

Json attributes_of(const Trial& trial) {
  Json attributes = {{"glint:trial", trial.number}};
  for (const auto& [name, value] : trial.outcome->scores) {
    attributes[name] = value;
  }
  if (!trial.outcome->message.empty()) {
    attributes["failure"] = trial.outcome->message;
  }
  return attributes;
}

/// @param start_s  when it began; evaluations are told as if one had followed the other from 1970
/// on
Json trial_line(const SearchSpace& space, const Goal& goal, const Trial& trial, double start_s) {
  const Outcome& outcome = *trial.outcome;
  const bool is_good = is_complete(goal, outcome);
  const bool is_several = has_several_objectives(goal);
  std::vector<double> values;
  for (const Objective& objective : objectives_of(goal)) {
    values.push_back(is_good ? outcome.scores.at(objective.name) : 0.0);
  }
  Json line = {{"op_code", kCreateTrial},
               {"worker_id", kWriter},
               {"study_id", 0},
               {"datetime_start", time_text(start_s)},
               {"state", is_good ? kComplete : kFail},
               {"value", is_good && !is_several ? Json(values.front()) : Json(nullptr)},
               {"values", is_good && is_several ? Json(values) : Json(nullptr)},
               {"datetime_complete", time_text(start_s + outcome.seconds)}};
  add_parameters(space, trial.point, line);
  line["user_attrs"] = attributes_of(trial);
  line["system_attrs"] = Json::object();
  if (is_good && !goal.constraints.empty()) {
    line["system_attrs"]["constraints"] = violations_of(goal, outcome.scores);
  }
  line["intermediate_values"] = Json::object();
  return line;
}

}  // namespace

std::string optuna_journal(const std::string& study_name,
                           const SearchSpace& space,
                           const Goal& goal,
                           std::span<const Trial> trials,
                           OptunaExport* counts) {
  OptunaExport count;
  Json directions = Json::array();
  for (const Objective& objective : objectives_of(goal)) {
    directions.push_back(objective.is_maximised ? kMaximise : kMinimise);
  }
  const Json head = {{"op_code", kCreateStudy},
                     {"worker_id", kWriter},
                     {"study_name", study_name},
                     {"directions", directions}};
  std::string text = head.dump() + "\n";
  double start_s = 0.0;
  for (const Trial& trial : trials) {
    if (!trial.outcome) {
      ++count.unfinished;
      continue;
    }
    const Json line = trial_line(space, goal, trial, start_s);
    start_s += trial.outcome->seconds;
    ++(line["state"] == kComplete ? count.complete : count.failed);
    text += line.dump() + "\n";
  }
  if (counts != nullptr) {
    *counts = count;
  }
  return text;
}

OptunaExport export_to_optuna(const fs::path& run, const fs::path& file) {
  std::error_code ignored;
  if (fs::exists(file, ignored)) {
    throw ConfigError(file.string() +
                      ": exists; Optuna appends to a journal, so that it is not "
                      "written over: give another name");
  }
  const Storage storage = Storage::read(run / "study.sqlite");
  const Study study = load_study(run / "study.resolved.toml", {});
  if (!study.has_search()) {
    throw ConfigError(run.string() + ": has searched nothing, there are no trials to export");
  }
  OptunaExport counts;
  const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
  write_file(file, optuna_journal(study.title, study.space, study.goal, trials, &counts));
  return counts;
}

}  // namespace glint
