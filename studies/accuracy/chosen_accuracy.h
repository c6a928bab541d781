// SPDX-License-Identifier: GPL-3.0-or-later
//
// [accuracy] in a run: the ladder tried on designs of the study (docs/accuracy.md).
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/rng.h"
#include "optimizer/storage/storage.h"
#include "studies/accuracy/accuracy_record.h"
#include "studies/accuracy/ladder_trial.h"
#include "studies/definition/ladder/branch_split.h"
#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/sampled/sampled_squares.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// What a run keeps of the evaluations that its choice rests on, beside study.sqlite: a trial for
/// each rung and design, whose name tells both. Resuming takes them from there.
inline constexpr const char* kAccuracyTrials = "accuracy.sqlite";

struct AccuracyTask {
  const Study& study;  ///< with [accuracy]
  SceneStore& store;
  Storage* record = nullptr;  ///< nullptr: nothing is kept
  int jobs = 1;               ///< designs at once
  const std::atomic<int>* interrupt = nullptr;
  Progress::Style progress = Progress::Style::kNone;
  std::function<void()> on_evaluation = {};  ///< after each that is kept, one call at a time
  /// A design at a rung. Empty: evaluate_at()
  std::function<Outcome(const Overrides& overrides, const RenderRung& rung)> evaluate = {};
  /// Random squares of it at two rungs. Empty: sampled_squares(); with evaluate: there are none,
  /// all checks are of whole pictures
  std::function<std::optional<std::vector<SampledSquare>>(const Overrides& overrides,
                                                          const RenderRung& cheap,
                                                          const RenderRung& dearer,
                                                          const Rng& rng)>
      sample = {};
};

/// The rung of a study's search. Where choices change the scene's kind it has branches, each with a
/// rung of its own, and of this one only split, branches and orders have a meaning.
struct ChosenAccuracy {
  std::vector<RenderRung> ladder;
  LadderChoice choice;
  std::vector<std::string>
      designs;  ///< names of the choice's designs: "baseline", "dome", "spread 3"
  /// Designs of the search that have been evaluated at the chosen rung: nothing is evaluated
  /// twice. Empty where the search needs derivatives.
  std::map<Point, Outcome> known;
  /// Designs of the search whose errors were beyond the bound of a rung before, newest first: the
  /// trial has them beside its twelve.
  std::vector<Trial> beyond;

  /// Why a check beyond the bound did not raise the rung: no dearer one renders the trial's
  /// designs.
  std::string stays;

  std::string label;   ///< of a branch: "lighting_use = ring"
  double share = 1.0;  ///< of a branch: of the search's designs; equal shares before it
  std::optional<BranchSplit> split = {};
  std::vector<ChosenAccuracy> branches = {};  ///< one for each of the split's values
  /// With "auto": of the designs of all branches together, each at its branch's rung.
  std::vector<OrderOf> orders = {};

  const RenderRung& rung() const { return ladder[choice.step]; }

  const RenderRung& top() const { return ladder.back(); }

  /// Of the branches; 0 where there are none.
  std::size_t index_of(const Point& point) const { return split ? split->branch_of(point) : 0; }

  /// What was chosen for the designs of a point's branch; this where there are none.
  const ChosenAccuracy& of(const Point& point) const;

  /// The branches; this alone where there are none.
  std::span<const ChosenAccuracy> parts() const;

  /// The rungs of the search.
  SearchRungs rungs() const;

  /// The least rules by which a search is rendered so: those of AccuracyRecord::begin_search().
  int rules() const;

  /// Counted, of an evaluation of the search by the shares of its designs.
  double evaluation_work() const;
  double full_evaluation_work() const;  ///< at the top
};

/// What a search wants of each candidate, but for derivatives: the scores of its goal, and those
/// that [accuracy] names.
WantedScores wanted_in_trial(const Study& study);

/// A design of the study at a rung, as its search would evaluate it, but without derivatives and
/// before less_offsets(); as it comes back from a database. What cannot be evaluated is a failed
/// outcome. @throws IoError
Outcome evaluate_at(SceneStore& store,
                    const Study& study,
                    const Overrides& overrides,
                    const RenderRung& rung);

/// What can be refused before anything is evaluated: keys set by hand that leave one way to render,
/// trials of an earlier run, which were rendered otherwise. Nothing without [accuracy].
/// @param takes_trials  the search begins with those of an earlier run
/// @throws ConfigError
void check_accuracy_choice(const Study& study, bool takes_trials);

/// Tries the ladder on the baseline, up to eight prototypes and a Sobol sequence over the
/// variables, twelve designs in all; where branch_split() finds one, a ladder of each branch on
/// eight designs of it. A search that began by rules that knew no branches, or those of one choice
/// alone, goes on so. The same for any number of threads and jobs, and whatever part of it was
/// recorded before.
/// @throws ConfigError with its place when the study leaves nothing to choose; at once, without any
///         evaluation, when the record's search has begun and its trial is not all that this
///         program would try: its ladder was another one
/// @throws EvaluationAborted when interrupted; what was evaluated is recorded
/// @throws IoError
ChosenAccuracy choose_accuracy(const AccuracyTask& task);
ChosenAccuracy choose_accuracy(const AccuracyTask& task, AccuracyRecord& record);

/// Whether a search, or one of its branches, may use a dearer rung.
bool has_dearer_rung(const ChosenAccuracy& part);

/// Tries the ladder once more, that of its branch where there are some, above the rung of before
/// and with a design that left its bound. With "auto" other branches may rise with it.
/// @param beyond    of the search
/// @param archived  trials of the search, of which some may be known at the new rung
/// @return nothing where the search may use no dearer rung
/// @throws EvaluationAborted when interrupted; IoError
std::optional<ChosenAccuracy> raise_accuracy(const AccuracyTask& task,
                                             AccuracyRecord& record,
                                             const ChosenAccuracy& before,
                                             const Trial& beyond,
                                             std::span<const Trial> archived);

/// task.evaluate of a trial of the search, or what the record knows of it.
/// @throws EvaluationAborted when interrupted; IoError
Outcome recorded_trial(const AccuracyTask& task,
                       AccuracyRecord& record,
                       const Trial& trial,
                       const RenderRung& rung);

/// Under which name the record keeps outcomes of the search at a rung: those that are corrected are
/// none of the rung itself.
std::string kept_name(const RenderRung& rung);

/// Sets the shares of the branches by the trials of a search.
void count_designs(ChosenAccuracy& chosen, std::span<const Trial> trials);

/// What a run's search was rendered by, as its result.json tells; empty without [accuracy].
/// @param study  of the run's study.resolved.toml
/// @throws IoError when result.json is missing or tells no rung of the study's ladders
std::optional<SearchRungs> rungs_of_run(const Study& study, const std::filesystem::path& run);

}  // namespace glint
