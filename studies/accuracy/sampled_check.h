// SPDX-License-Identifier: GPL-3.0-or-later
//
// A design of a search checked in random pixels: whether its scores are within their bounds of
// those of a dearer rung, for a part of what its whole picture would take (docs/accuracy.md,
// "Random pixels"). It can only confirm a bound; what it leaves in doubt is evaluated as a whole.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "studies/accuracy/chosen_accuracy.h"
#include "studies/accuracy/sampled_error.h"

namespace glint {

struct SampledCheck {
  int pixels = 0;                              ///< of the region of interest
  int squares = 0;                             ///< that they lie in
  std::map<std::string, SampledError> errors;  ///< by score
};

/// Whether designs of a search, or of a branch, may be checked in random pixels at some of its
/// rungs: each score that has a bound follows from squares, and the picture is large enough. Notes
/// nothing of the rung that is taken, so that an epoch does not change it.
bool may_be_sampled(const AccuracyTask& task, const ChosenAccuracy& part);

/// What such a check takes, counted: both rungs in share_of_squares() of the picture. Nothing where
/// the whole picture is evaluated at once: at rungs that are no paths in all pixels, or where the
/// squares would take more than half as much.
std::optional<double> sampled_work(const AccuracyTask& task,
                                   const ChosenAccuracy& part,
                                   const RenderRung& dearer);

/// A trial of the search in random pixels by its rung and a dearer one, or what the record knows of
/// it. The squares follow from the study's seed and the trial's number alone.
/// @return nothing where the design's picture cannot be rendered in parts, which is recorded too
/// @throws EvaluationAborted when interrupted; IoError
std::optional<SampledCheck> recorded_sample(const AccuracyTask& task,
                                            AccuracyRecord& record,
                                            const ChosenAccuracy& part,
                                            const Trial& trial,
                                            const RenderRung& dearer);

/// Whether each score is within its bound_of() at the confidence of [accuracy]: the size of its
/// difference and Student's interval of it together. False for what was not sampled, and where the
/// squares are no picture of the whole: off by more than the bound and by more than their interval.
bool is_confirmed(const ChosenAccuracy& part,
                  const Scores& scores,
                  const SampledCheck& check,
                  double confidence);

}  // namespace glint
