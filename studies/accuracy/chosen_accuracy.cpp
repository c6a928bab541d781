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
#include "studies/accuracy/tried_designs.h"

namespace glint {
namespace {

/// Whether the rungs differ for a design. Those of paths render a mirror alike, so that no
/// difference tells how far it is off.
bool is_of_ladder(const Study& study,
                  const std::vector<RenderRung>& ladder,
                  const TriedDesign& design) {
  try {
    return !is_rendered_alike(scene_with(study, design.overrides), ladder);
  } catch (const ConfigError&) {  // it fails on every rung
    return true;
  }
}

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

Outcome evaluated(const AccuracyTask& task, const Overrides& overrides, const RenderRung& rung) {
  return task.evaluate ? task.evaluate(overrides, rung)
                       : evaluate_at(task.store, task.study, overrides, rung);
}

/// A search that has begun knows all that its first rung was chosen from.
void refuse_new_rung(const std::string& begun, const std::string& rung) {
  throw ConfigError(
      fmt::format("this study cannot be resumed: its search began with \"{}\", and \"{}\" would "
                  "now be tried before, which it was not; the program or a library changed since, "
                  "or accuracy.sqlite is not whole. Run into a new folder; the old best design can "
                  "be given as a start point",
                  begun,
                  rung));
}

/// Evaluates candidates at rungs, each once.
class RungEvaluator {
 public:
  /// @param beyond  designs of the search that come first
  /// @param begun   the rung of a search whose trial is over: nothing is evaluated any more
  RungEvaluator(const AccuracyTask& task,
                AccuracyRecord& record,
                const std::vector<RenderRung>& ladder,
                const std::vector<Trial>& beyond,
                std::optional<std::string> begun)
      : task_(task),
        record_(record),
        ladder_(ladder),
        begun_(std::move(begun)),
        bar_(task.study.name + ": ways to render",
             static_cast<std::int64_t>(ladder.size() * kTriedDesigns),
             task.progress) {
    for (const Trial& trial : beyond) {
      candidates_.push_back(
          {trial_name(trial.number), overrides_of(task.study, trial.point), trial.point});
    }
    std::ranges::copy(tried_designs(task.study), std::back_inserter(candidates_));
  }

  const std::vector<TriedDesign>& candidates() const { return candidates_; }

  /// The candidates on which the rungs differ; all rungs render the others alike.
  std::vector<std::size_t> of_ladder() const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (is_of_ladder(task_.study, ladder_, candidates_[i])) {
        found.push_back(i);
      }
    }
    return found;
  }

  std::vector<std::optional<Scores>> scores(std::size_t step,
                                            std::span<const std::size_t> candidates) {
    evaluate_all(step, candidates);
    std::vector<std::optional<Scores>> found;
    for (const std::size_t candidate : candidates) {
      const Outcome* known = find(step, candidate);
      found.push_back(known == nullptr || known->is_failed ? std::optional<Scores>()
                                                           : known->scores);
    }
    return found;
  }

  const Outcome& outcome(std::size_t step, std::size_t candidate) const {
    return *find(step, candidate);
  }

 private:
  const Outcome* find(std::size_t step, std::size_t candidate) const {
    return record_.find(ladder_[step].name, candidates_[candidate].name);
  }

  /// Those that are to be evaluated.
  /// @throws ConfigError when there are any, and the trial is over
  std::vector<std::size_t> missing_of(std::size_t step,
                                      std::span<const std::size_t> candidates) const {
    std::vector<std::size_t> missing;
    std::ranges::copy_if(candidates, std::back_inserter(missing), [&](std::size_t candidate) {
      return find(step, candidate) == nullptr;
    });
    if (begun_ && !missing.empty()) {
      refuse_new_rung(*begun_, ladder_[step].name);
    }
    return missing;
  }

  void evaluate_all(std::size_t step, std::span<const std::size_t> candidates) {
    const std::vector<std::size_t> missing = missing_of(step, candidates);
    run_jobs(missing.size(), task_.jobs, [&](std::size_t i) { evaluate_one(step, missing[i]); });
  }

  void evaluate_one(std::size_t step, std::size_t candidate) {
    if (task_.interrupt != nullptr && *task_.interrupt > 0) {
      throw EvaluationAborted();
    }
    const TriedDesign& design = candidates_[candidate];
    const Outcome outcome = evaluated(task_, design.overrides, ladder_[step]);
    const std::lock_guard lock(mutex_);
    record_.keep(ladder_[step].name, design.name, design.point.value_or(Point{}), outcome);
    bar_.update(++done_);
    if (task_.on_evaluation) {
      task_.on_evaluation();
    }
  }

  const AccuracyTask& task_;
  AccuracyRecord& record_;
  const std::vector<RenderRung>& ladder_;
  std::optional<std::string> begun_;
  std::vector<TriedDesign> candidates_;
  std::mutex mutex_;
  Progress bar_;
  int done_ = 0;
};

/// @param num_beyond      designs that are wanted beside the twelve
/// @param num_candidates  on which the rungs differ
LadderTask ladder_task(const Study& study,
                       const std::vector<RenderRung>& ladder,
                       std::size_t num_beyond,
                       std::size_t num_candidates) {
  LadderTask task = {.steps = {},
                     .num_designs = kTriedDesigns + num_beyond,
                     .num_candidates = num_candidates,
                     .wish = *study.accuracy,
                     .goal = study.goal};
  for (const RenderRung& rung : ladder) {
    task.steps.push_back({.name = rung.name,
                          .work = rung.work,
                          .group = rung.group,
                          .is_for_search = rung.is_for_search,
                          .fineness = fineness_of(rung),
                          .is_noisy = rung.is_noisy,
                          .is_corrected = rung.pixel_factor > 1});
  }
  return task;
}

/// The choice from candidates that stand at these places of a longer list, whose others all rungs
/// render alike.
LadderChoice choice_from(const LadderTask& task,
                         RungEvaluator& evaluator,
                         const std::vector<std::size_t>& places) {
  const auto placed = [&](std::span<const std::size_t> candidates) {
    std::vector<std::size_t> found;
    for (const std::size_t candidate : candidates) {
      found.push_back(places[candidate]);
    }
    return found;
  };
  LadderChoice choice =
      try_ladder(task, [&](std::size_t step, std::span<const std::size_t> candidates) {
        return evaluator.scores(step, placed(candidates));
      });
  const std::size_t asked = choice.designs.size() + choice.num_failed;
  const std::size_t num_all = evaluator.candidates().size();
  const std::size_t seen = asked < places.size() ? places[asked] : num_all;
  choice.num_alike = seen - asked;
  choice.designs = placed(choice.designs);
  if (choice.designs.size() < kMinDesigns && choice.num_alike > 0) {
    choice.problem += fmt::format("; the other {} are mirrors, which all ways to render show alike",
                                  choice.num_alike);
  }
  return choice;
}

/// An outcome at a rung as the search takes it: the record has it without correction.
Outcome as_searched(const Study& study,
                    const RenderRung& rung,
                    const Point& point,
                    Outcome outcome) {
  if (!rung.offsets.empty() && !outcome.is_failed) {
    less_offsets(scene_with(study, overrides_of(study, point)), rung, outcome.scores);
  }
  return outcome;
}

/// @param first_step  of the search: those below are tried, and not taken
/// @param begun       the rung of a search whose trial is over
ChosenAccuracy tried(const AccuracyTask& task,
                     AccuracyRecord& record,
                     ChosenAccuracy chosen,
                     std::size_t first_step,
                     std::optional<std::string> begun = {}) {
  RungEvaluator evaluator(task, record, chosen.ladder, chosen.beyond, std::move(begun));
  const std::vector<std::size_t> places = evaluator.of_ladder();
  LadderTask ladder = ladder_task(task.study, chosen.ladder, chosen.beyond.size(), places.size());
  for (std::size_t step = 0; step < first_step; ++step) {
    ladder.steps[step].is_for_search = false;
  }
  chosen.choice = choice_from(ladder, evaluator, places);
  const std::size_t step = chosen.choice.step;
  const bool is_tried = chosen.choice.steps[step].is_tried;
  for (std::size_t i = 0; i < chosen.ladder.size(); ++i) {
    chosen.ladder[i].offsets = chosen.choice.steps[i].offsets;
  }
  for (const std::size_t design : chosen.choice.designs) {
    const TriedDesign& candidate = evaluator.candidates()[design];
    chosen.designs.push_back(candidate.name);
    if (is_tried && candidate.point && !wants_derivatives(task.study)) {
      chosen.known[*candidate.point] =
          as_searched(task.study, chosen.rung(), *candidate.point, evaluator.outcome(step, design));
    }
  }
  return chosen;
}

}  // namespace

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
  check_ladder(study, search_ladder(study));
}

ChosenAccuracy choose_accuracy(const AccuracyTask& task) {
  AccuracyRecord record(task.record);
  return choose_accuracy(task, record);
}

ChosenAccuracy choose_accuracy(const AccuracyTask& task, AccuracyRecord& record) {
  ChosenAccuracy chosen;
  chosen.ladder = search_ladder(task.study);
  check_ladder(task.study, chosen.ladder);
  return tried(task, record, std::move(chosen), 0, record.begun_rung());
}

bool has_dearer_rung(const ChosenAccuracy& chosen) {
  return std::any_of(chosen.ladder.begin() + static_cast<std::ptrdiff_t>(chosen.choice.step) + 1,
                     chosen.ladder.end(),
                     [](const RenderRung& rung) { return rung.is_for_search; });
}

std::optional<ChosenAccuracy> raise_accuracy(const AccuracyTask& task,
                                             AccuracyRecord& record,
                                             const ChosenAccuracy& before,
                                             const Trial& beyond,
                                             std::span<const Trial> archived) {
  if (!has_dearer_rung(before)) {
    return std::nullopt;
  }
  ChosenAccuracy raised;
  raised.ladder = before.ladder;
  for (RenderRung& rung : raised.ladder) {
    rung.offsets.clear();  // of the trial before
  }
  raised.beyond = before.beyond;
  raised.beyond.insert(raised.beyond.begin(), beyond);
  raised = tried(task, record, std::move(raised), before.choice.step + 1);
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
  const Outcome outcome = evaluated(task, overrides_of(task.study, trial.point), rung);
  record.keep(rung.name, trial_name(trial.number), trial.point, outcome);
  if (task.on_evaluation) {
    task.on_evaluation();
  }
  return outcome;
}

std::optional<RenderRung> rung_of_run(const Study& study, const std::filesystem::path& run) {
  if (!study.accuracy) {
    return std::nullopt;
  }
  const auto result = nlohmann::json::parse(read_file(run / "result.json"), nullptr, false);
  const auto accuracy = result.is_object() ? result.find("accuracy") : result.end();
  const std::string name = accuracy != result.end() && accuracy->is_object()
                               ? accuracy->value("rung", std::string())
                               : std::string();
  for (RenderRung& rung : search_ladder(study)) {
    if (rung.name == name) {
      rung.offsets = accuracy->value("offsets", std::map<std::string, double>());
      return rung;
    }
  }
  throw IoError(fmt::format("{}: does not say how the search was rendered; finish the run first",
                            (run / "result.json").string()));
}

}  // namespace glint
