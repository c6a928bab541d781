// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/run_analysis.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/thread_pool.h"
#include "core/wall_clock.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/algorithm/sobol.h"
#include "optimizer/storage/storage.h"
#include "studies/accuracy/chosen_accuracy.h"
#include "studies/analysis/analysis_json.h"
#include "studies/analysis/branches.h"
#include "studies/definition/study.h"
#include "studies/definition/study_text.h"
#include "studies/output/provenance.h"
#include "studies/output/read_json.h"
#include "studies/run/begun_study.h"
#include "studies/run/study_search.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

/// Keeps the added designs apart from those that a search of the same seed begins with.
constexpr std::uint64_t kDesignSeeds = 1ULL << 40;

Study searched_study(const fs::path& run) {
  if (!fs::exists(run / "study.resolved.toml") || !fs::exists(run / "study.sqlite")) {
    throw IoError(run.string() + ": is no run directory with a search: study.sqlite is missing");
  }
  Study study = load_study(run / "study.resolved.toml", {});
  if (!study.has_search()) {
    throw ConfigError(run.string() + ": has searched nothing, there are no trials to analyse");
  }
  return study;
}

Storage open_added(const Study& study, const fs::path& run) {
  StudyIdentity identity = {.config_hash = config_hash(study),
                            .config_text = resolved_text(study),
                            .code_version = program_version(),
                            .seed = study.search.seed};
  const fs::path database = run / kAddedDesigns;
  if (fs::exists(database)) {
    const StudyIdentity recorded = Storage::read(database).identity();
    if (is_recorded_as(study, recorded.config_hash, recorded.config_text)) {
      identity.config_hash = recorded.config_hash;
    }
  }
  return Storage::open(database, identity);
}

/// The rungs that added designs of a run with [accuracy] were rendered by. Empty: a program before
/// did not note them, and they count as rendered as the search is.
std::string recorded_rungs(const Storage& added) {
  std::string recorded;
  for (const Event& event : added.events()) {
    recorded = event.kind == EventKind::kEpoch ? event.text : recorded;
  }
  return recorded;
}

/// Withdraws designs of rungs that the search has left since.
void begin_with_rungs(const SearchRungs& rungs, Storage& added) {
  const std::string recorded = recorded_rungs(added);
  const Event event = {.kind = EventKind::kEpoch, .text = rungs.name()};
  if (recorded.empty()) {
    added.append(std::vector<Event>{event});
  } else if (recorded != event.text) {
    added.begin_epoch(event);
  }
}

/// Those with an outcome that is as the search's own are rendered.
std::vector<Trial> added_designs(const Study& study, const fs::path& run) {
  if (!fs::exists(run / kAddedDesigns)) {
    return {};
  }
  const Storage storage = Storage::read(run / kAddedDesigns);
  const std::string recorded = study.accuracy ? recorded_rungs(storage) : std::string();
  if (!recorded.empty() && recorded != rungs_of_run(study, run)->name()) {
    return {};
  }
  std::vector<Trial> added = storage.trials(TrialKind::kSearch);
  std::erase_if(added, [](const Trial& trial) { return !trial.outcome; });
  return added;
}

/// A failed design is data: the others go on.
/// @param rung  as the search was rendered; nullptr: as the study says
Outcome outcome_of(SceneStore& store,
                   const Study& study,
                   const Point& point,
                   const RenderRung* rung) {
  const auto start = std::chrono::steady_clock::now();
  Outcome outcome;
  try {
    outcome = evaluate_candidate(store, study, point, rung);
  } catch (const IoError&) {
    throw;  // says nothing about the design
  } catch (const Error& error) {
    outcome = {.is_failed = true, .message = error.what()};
  }
  std::erase_if(outcome.scores, [](const auto& score) { return !std::isfinite(score.second); });
  outcome.gradients.clear();
  outcome.seconds = seconds_since(start);
  return outcome;
}

/// Scores that the goal names, each once.
std::vector<std::string> named_scores(const Goal& goal) {
  std::vector<std::string> names;
  for (const Objective& objective : objectives_of(goal)) {
    names.push_back(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    if (std::ranges::count(names, constraint.name) == 0) {
      names.push_back(constraint.name);
    }
  }
  return names;
}

/// result.json; an object without anything where the run has not ended once.
Json result_of(const fs::path& run) {
  const fs::path file = run / "result.json";
  return fs::exists(file) ? read_json(file) : Json::object();
}

/// The run's own best design where that keeps the limits as the run judges them.
/// @param searched  trials of the search, by number
std::optional<Point> answer_of(const Study& study,
                               const Json& result,
                               std::span<const Trial> searched) {
  const Json best = result.value("best", Json());
  const int number = best.is_object() ? best.value("trial", 0) : 0;
  const auto found = std::ranges::find(searched, number, &Trial::number);
  if (found == searched.end() || !found->outcome || found->outcome->is_failed) {
    return std::nullopt;
  }
  const bool is_feasible_seen = is_feasible(study.goal, found->outcome->scores);
  return best.value("feasible", is_feasible_seen)
             ? std::optional(canonical(study.space, found->point))
             : std::nullopt;
}

/// Of noisy scores the answer of the run itself and, in other branches, what is expected to be the
/// best, so that no response goes through a lucky evaluation.
/// @param trials  of the search, and added ones
BestDesigns best_of_run(const Study& study,
                        const Json& result,
                        std::span<const Trial> searched,
                        std::span<const Trial> trials,
                        std::span<const FittedScore> fitted) {
  if (!study.search.is_noisy && !result.contains("race")) {
    return best_seen(study.space, study.goal, trials);
  }
  const SearchTask task = search_task(study, 1);
  std::vector<std::string> exact = task.exact.names;
  exact.insert(exact.end(), task.steady.begin(), task.steady.end());
  BestDesigns best = study.search.is_noisy
                         ? best_expected(study.space, study.goal, trials, fitted, exact)
                         : best_seen(study.space, study.goal, trials);
  if (const std::optional<Point> answer = answer_of(study, result, searched)) {
    best[branch_names(study.space, {&*answer, 1}).front()] = *answer;
  }
  return best;
}

}  // namespace

int add_designs(const fs::path& run, const AddOptions& options) {
  const Study study = searched_study(run);
  const std::optional<SearchRungs> rungs = rungs_of_run(study, run);
  Storage storage = open_added(study, run);
  if (rungs) {
    begin_with_rungs(*rungs, storage);
  }
  std::map<int, Trial> known;
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    known[trial.number] = trial;
  }
  const Sobol sequence(study.search.seed + kDesignSeeds,
                       static_cast<int>(study.space.variables.size()));
  ThreadPool pool(options.threads);
  SceneStore store(pool);
  Progress bar("designs for the analysis", options.count, options.progress);
  int evaluated = 0;
  for (int number = 1; number <= options.count; ++number) {
    const auto found = known.find(number);
    if (found == known.end() || !found->second.outcome) {
      const Trial trial = {
          .number = number,
          .point =
              point_from_unit(study.space, sequence.point(static_cast<std::uint32_t>(number) - 1))};
      if (found == known.end()) {
        storage.append(std::vector<Event>{{.kind = EventKind::kAsk, .trial = number}},
                       std::vector<Trial>{trial});
      }
      storage.record(
          TrialKind::kSearch,
          number,
          outcome_of(store, study, trial.point, rungs ? &rungs->of(trial.point) : nullptr));
      ++evaluated;
    }
    bar.update(number);
  }
  return evaluated;
}

Json analyse_run(const fs::path& run) {
  const Study study = searched_study(run);
  std::vector<Trial> trials = Storage::read(run / "study.sqlite").trials(TrialKind::kSearch);
  std::erase_if(trials, [](const Trial& trial) { return !trial.outcome; });
  const std::size_t num_searched = trials.size();
  std::ranges::move(added_designs(study, run), std::back_inserter(trials));
  std::vector<FittedScore> fitted;
  for (const std::string& name : named_scores(study.goal)) {
    fitted.push_back(fit_score(study.space, trials, name));
  }
  const BestDesigns best =
      best_of_run(study, result_of(run), std::span(trials).first(num_searched), trials, fitted);
  Json scores = Json::array();
  for (const FittedScore& one : fitted) {
    scores.push_back(analysis_json(study.space, analyse_score(study.space, one, best)));
  }
  return {{"added", trials.size() - num_searched}, {"scores", scores}};
}

}  // namespace glint
