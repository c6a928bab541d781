// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/chosen_accuracy.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/jobs.h"
#include "optimizer/search/search.h"
#include "studies/accuracy/branch_trials.h"
#include "studies/accuracy/design_trial.h"
#include "studies/accuracy/tried_designs.h"

namespace glint {
namespace {

/// What the database does not keep would make a resumed trial another one.
void make_storable(Outcome& outcome) {
  std::erase_if(outcome.scores, [](const auto& score) { return !std::isfinite(score.second); });
  for (auto& [name, value] : outcome.scores) {
    value += 0.0;  // no negative zero
  }
  outcome.gradients.clear();
  outcome.remarks.clear();
  outcome.seconds = 0.0;
}

/// A search needs something to choose in one of its ladders.
void check_ladders(const Study& study, const std::optional<BranchSplit>& split) {
  if (!split) {
    check_ladder(study, search_ladder(study));
    return;
  }
  std::vector<RenderRung> rungs;
  for (const TrialDesigns& designs : tried_designs(study, *split)) {
    rungs = branch_ladder(study, designs);
    if (std::ranges::count_if(rungs, &RenderRung::is_for_search) > 1) {
      return;
    }
  }
  check_ladder(study, rungs);
}

/// Of a search that was begun by these rules.
std::optional<BranchSplit> split_by_rules(const Study& study, int rules) {
  if (rules >= kCombinedRules) {
    return branch_split(study);
  }
  return rules == kBranchRules ? one_choice_split(study) : std::nullopt;
}

/// The rung of a ladder that a run's result tells.
/// @param told  { rung, offsets }
std::optional<RenderRung> told_of(std::vector<RenderRung> ladder, const nlohmann::json& told) {
  const std::string name = told.is_object() ? told.value("rung", std::string()) : std::string();
  const auto found = std::ranges::find(ladder, name, &RenderRung::name);
  if (found == ladder.end()) {
    return std::nullopt;
  }
  found->offsets = told.value("offsets", std::map<std::string, double>());
  return *found;
}

std::optional<SearchRungs> told_rung(const Study& study, const nlohmann::json& told) {
  const std::optional<RenderRung> rung = told_of(search_ladder(study), told);
  return rung ? std::optional(SearchRungs{.split = {}, .rungs = {*rung}}) : std::nullopt;
}

/// The branches of a search by the names of their choices: those of this program, or of one choice
/// alone.
std::optional<BranchSplit> split_named(const Study& study, const std::string& name) {
  std::optional<BranchSplit> split = branch_split(study);
  if (split && split->name != name) {
    split = one_choice_split(study);
  }
  return split && split->name == name ? split : std::nullopt;
}

/// @param accuracy  with the names of the choices and one of each branch, in their order
std::optional<SearchRungs> told_branches(const Study& study, const nlohmann::json& accuracy) {
  const nlohmann::json& told = accuracy["branches"];
  SearchRungs rungs = {.split = split_named(study, accuracy.value("variable", std::string())),
                       .rungs = {}};
  if (!rungs.split || !told.is_array() || told.size() != rungs.split->values.size()) {
    return std::nullopt;
  }
  const std::vector<TrialDesigns> designs = tried_designs(study, *rungs.split);
  for (std::size_t branch = 0; branch < designs.size(); ++branch) {
    const auto rung = told_of(branch_ladder(study, designs[branch]), told[branch]);
    if (!rung) {
      return std::nullopt;
    }
    rungs.rungs.push_back(*rung);
  }
  return rungs;
}

}  // namespace

const ChosenAccuracy& ChosenAccuracy::of(const Point& point) const {
  return split ? branches[split->branch_of(point)] : *this;
}

std::span<const ChosenAccuracy> ChosenAccuracy::parts() const {
  return split ? std::span<const ChosenAccuracy>(branches)
               : std::span<const ChosenAccuracy>(this, 1);
}

SearchRungs ChosenAccuracy::rungs() const {
  SearchRungs found = {.split = split, .rungs = {}};
  for (const ChosenAccuracy& part : parts()) {
    found.rungs.push_back(part.rung());
  }
  return found;
}

int ChosenAccuracy::rules() const {
  if (!split) {
    return kAccuracyRules;
  }
  return split->choices.size() > 1 ? kCombinedRules : kBranchRules;
}

double ChosenAccuracy::evaluation_work() const {
  double work = 0.0;
  for (const ChosenAccuracy& part : parts()) {
    work += part.share * part.rung().work;
  }
  return work;
}

double ChosenAccuracy::full_evaluation_work() const {
  double work = 0.0;
  for (const ChosenAccuracy& part : parts()) {
    work += part.share * part.top().work;
  }
  return work;
}

WantedScores wanted_in_trial(const Study& study) {
  Goal goal = study.goal;
  for (const ScoreWish& wish : study.accuracy ? study.accuracy->wishes : std::vector<ScoreWish>()) {
    goal.constraints.push_back({.name = wish.score});
  }
  return study.has_needed_scores_only ? needed_by(goal) : wanted_by(goal);
}

Outcome evaluate_at(SceneStore& store,
                    const Study& study,
                    const Overrides& overrides,
                    const RenderRung& rung) {
  Outcome outcome;
  try {
    outcome.scores =
        evaluate(store, at_rung(scene_with(study, overrides), rung), {}, wanted_in_trial(study))
            .scores;
  } catch (const IoError&) {
    throw;
  } catch (const Error& error) {
    outcome = {.is_failed = true, .message = error.what()};
  }
  make_storable(outcome);
  return outcome;
}

void check_accuracy_choice(const Study& study, bool takes_trials) {
  if (!study.accuracy) {
    return;
  }
  if (takes_trials) {
    throw ConfigError(
        "--from: the study's [accuracy] chooses how its search is rendered, and trials of another "
        "run may have been rendered otherwise; begin without --from, or without [accuracy]");
  }
  check_ladders(study, branch_split(study));
}

ChosenAccuracy choose_accuracy(const AccuracyTask& task) {
  AccuracyRecord record(task.record);
  return choose_accuracy(task, record);
}

ChosenAccuracy choose_accuracy(const AccuracyTask& task, AccuracyRecord& record) {
  const std::optional<BranchSplit> split =
      split_by_rules(task.study, record.begun_rules().value_or(kCombinedRules));
  check_ladders(task.study, split);
  if (split) {
    return choose_branches(task, record, *split);
  }
  ChosenAccuracy chosen;
  chosen.ladder = search_ladder(task.study);
  return tried(task,
               record,
               std::move(chosen),
               {.designs = {tried_designs(task.study), kTriedDesigns},
                .first_step = 0,
                .begun = record.begun_rung()});
}

bool has_dearer_rung(const ChosenAccuracy& part) {
  return std::any_of(part.ladder.begin() + static_cast<std::ptrdiff_t>(part.choice.step) + 1,
                     part.ladder.end(),
                     [](const RenderRung& rung) { return rung.is_for_search; });
}

std::optional<ChosenAccuracy> raise_accuracy(const AccuracyTask& task,
                                             AccuracyRecord& record,
                                             const ChosenAccuracy& before,
                                             const Trial& beyond,
                                             std::span<const Trial> archived) {
  if (!has_dearer_rung(before.of(beyond.point))) {
    return std::nullopt;
  }
  if (before.split) {
    return raise_branches(task, record, before, beyond, archived);
  }
  ChosenAccuracy raised = tried(task,
                                record,
                                untried_again(before, beyond),
                                {.designs = {tried_designs(task.study), kTriedDesigns},
                                 .first_step = before.choice.step + 1,
                                 .begun = {}});
  for (const Trial& trial : archived) {
    const Outcome* known = record.find(raised.rung().name, trial_name(trial.number));
    if (known != nullptr && !wants_derivatives(task.study)) {
      raised.known[trial.point] = as_searched(task.study, raised.rung(), trial.point, *known);
    }
  }
  return raised;
}

Outcome recorded_trial(const AccuracyTask& task,
                       AccuracyRecord& record,
                       const Trial& trial,
                       const RenderRung& rung) {
  if (const Outcome* known = record.find(rung.name, trial_name(trial.number))) {
    return *known;
  }
  if (task.interrupt != nullptr && *task.interrupt > 0) {
    throw EvaluationAborted();
  }
  Outcome outcome = evaluated(task, overrides_of(task.study, trial.point), rung);
  record.keep(rung.name, trial_name(trial.number), trial.point, outcome);
  if (task.on_evaluation) {
    task.on_evaluation();
  }
  return outcome;
}

std::string kept_name(const RenderRung& rung) {
  return rung.offsets.empty() ? rung.name : rung.name + std::string(kCorrected);
}

void count_designs(ChosenAccuracy& chosen, std::span<const Trial> trials) {
  if (chosen.branches.empty() || trials.empty()) {
    return;
  }
  std::vector<std::size_t> counts(chosen.branches.size(), 0);
  for (const Trial& trial : trials) {
    ++counts[chosen.index_of(trial.point)];
  }
  for (std::size_t branch = 0; branch < counts.size(); ++branch) {
    chosen.branches[branch].share =
        static_cast<double>(counts[branch]) / static_cast<double>(trials.size());
  }
}

std::optional<SearchRungs> rungs_of_run(const Study& study, const std::filesystem::path& run) {
  if (!study.accuracy) {
    return std::nullopt;
  }
  const auto result = nlohmann::json::parse(read_file(run / "result.json"), nullptr, false);
  const auto accuracy = result.is_object() ? result.find("accuracy") : result.end();
  const nlohmann::json told = accuracy != result.end() ? *accuracy : nlohmann::json();
  std::optional<SearchRungs> rungs =
      told.contains("branches") ? told_branches(study, told) : told_rung(study, told);
  if (!rungs) {
    throw IoError(fmt::format("{}: does not say how the search was rendered; finish the run first",
                              (run / "result.json").string()));
  }
  return rungs;
}

}  // namespace glint
