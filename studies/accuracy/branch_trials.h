// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ladders of a search's branches, each tried on designs of its own (docs/accuracy.md,
// "Branches").
#pragma once

#include <optional>
#include <span>

#include "studies/accuracy/chosen_accuracy.h"

namespace glint {

/// A rung for each branch. With tolerances each is the cheapest that keeps them in its branch. With
/// "auto" all designs are ranked together, each at its branch's rung, against their tops: the rung
/// of the branch whose next one takes the least work rises until that ranking is right; then each
/// branch, that of the dearest rung first, goes back to the cheapest rung by which it stays so.
/// @throws as choose_accuracy()
ChosenAccuracy choose_branches(const AccuracyTask& task,
                               AccuracyRecord& record,
                               const BranchSplit& split);

/// The ladder of one branch tried once more, above its rung and with a design that left its bound.
/// With "auto" other branches rise with it where the ranking needs it; none goes below its rung.
/// Designs of branches whose rung stays are known.
/// @param before  whose branch of that design may use a dearer rung
/// @throws as raise_accuracy()
ChosenAccuracy raise_branches(const AccuracyTask& task,
                              AccuracyRecord& record,
                              const ChosenAccuracy& before,
                              const Trial& beyond,
                              std::span<const Trial> archived);

}  // namespace glint
