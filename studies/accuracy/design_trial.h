// SPDX-License-Identifier: GPL-3.0-or-later
//
// A ladder tried on designs of a study: those of all of it, or of a branch.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "studies/accuracy/chosen_accuracy.h"
#include "studies/accuracy/tried_designs.h"

namespace glint {

struct TrialStart {
  TrialDesigns designs;
  std::size_t first_step = 0;        ///< of the search: those below are tried, and not taken
  std::optional<std::string> begun;  ///< the rung of a search whose trial is over
  /// Others decide whether designs are ranked rightly: the first step that renders all designs is
  /// taken.
  bool is_judged_jointly = false;
};

/// The choice from a ladder, with what its designs gave at the rung that is taken.
/// @param chosen  with its ladder and the designs of the search that come first
/// @throws ConfigError where a trial that is over does not know all; EvaluationAborted, IoError
ChosenAccuracy tried(const AccuracyTask& task,
                     AccuracyRecord& record,
                     ChosenAccuracy chosen,
                     const TrialStart& start);

/// The same ladder before it is tried, with the designs of the search that left a bound of it.
ChosenAccuracy untried(const ChosenAccuracy& part);

/// And with one more of them. @param beyond  newer than the others
ChosenAccuracy untried_again(const ChosenAccuracy& part, const Trial& beyond);

/// A design at a rung by who evaluates for the task.
Outcome evaluated(const AccuracyTask& task, const Overrides& overrides, const RenderRung& rung);

/// An outcome at a rung as the search takes it: the record has it without correction.
Outcome as_searched(const Study& study,
                    const RenderRung& rung,
                    const Point& point,
                    Outcome outcome);

}  // namespace glint
