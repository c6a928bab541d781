// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/design_trial.h"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "core/jobs.h"
#include "optimizer/search/search.h"

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
  /// Designs of the search that were beyond a bound come first. Where the search has begun, nothing
  /// is evaluated any more.
  RungEvaluator(const AccuracyTask& task,
                AccuracyRecord& record,
                const ChosenAccuracy& chosen,
                const TrialStart& start)
      : task_(task),
        record_(record),
        ladder_(chosen.ladder),
        begun_(start.begun),
        bar_(task.study.name + ": ways to render",
             static_cast<std::int64_t>(chosen.ladder.size() * start.designs.wanted),
             task.progress) {
    for (const Trial& trial : chosen.beyond) {
      candidates_.push_back(
          {trial_name(trial.number), overrides_of(task.study, trial.point), trial.point});
    }
    std::ranges::copy(start.designs.candidates, std::back_inserter(candidates_));
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

/// @param num_designs     that are wanted
/// @param num_candidates  on which the rungs differ
LadderTask ladder_task(const Study& study,
                       const std::vector<RenderRung>& ladder,
                       std::size_t num_designs,
                       std::size_t num_candidates) {
  LadderTask task = {.steps = {},
                     .num_designs = num_designs,
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

}  // namespace

ChosenAccuracy untried(const ChosenAccuracy& part) {
  ChosenAccuracy fresh;
  fresh.ladder = part.ladder;
  for (RenderRung& rung : fresh.ladder) {
    rung.offsets.clear();  // of the trial before
  }
  fresh.beyond = part.beyond;
  fresh.label = part.label;
  fresh.share = part.share;
  return fresh;
}

ChosenAccuracy untried_again(const ChosenAccuracy& part, const Trial& beyond) {
  ChosenAccuracy fresh = untried(part);
  fresh.beyond.insert(fresh.beyond.begin(), beyond);
  return fresh;
}

Outcome evaluated(const AccuracyTask& task, const Overrides& overrides, const RenderRung& rung) {
  return task.evaluate ? task.evaluate(overrides, rung)
                       : evaluate_at(task.store, task.study, overrides, rung);
}

Outcome as_searched(const Study& study,
                    const RenderRung& rung,
                    const Point& point,
                    Outcome outcome) {
  if (!rung.offsets.empty() && !outcome.is_failed) {
    less_offsets(scene_with(study, overrides_of(study, point)), rung, outcome.scores);
  }
  return outcome;
}

ChosenAccuracy tried(const AccuracyTask& task,
                     AccuracyRecord& record,
                     ChosenAccuracy chosen,
                     const TrialStart& start) {
  RungEvaluator evaluator(task, record, chosen, start);
  const std::vector<std::size_t> places = evaluator.of_ladder();
  const std::size_t wanted = start.designs.wanted + chosen.beyond.size();
  LadderTask ladder = ladder_task(task.study, chosen.ladder, wanted, places.size());
  ladder.is_judged_jointly = start.is_judged_jointly;
  for (std::size_t step = 0; step < start.first_step; ++step) {
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

}  // namespace glint
