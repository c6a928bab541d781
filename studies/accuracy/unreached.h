// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is told where no step of a ladder serves: the bounds that are to be had.
#pragma once

#include <string>
#include <vector>

#include "studies/accuracy/ladder_trial.h"

namespace glint {

/// A sentence for each score that is not as exact as asked for, with the bound that is reached.
/// @param choice         whose steps are judged
/// @param ranks_nothing  of "auto": the top tells none of the designs apart
std::vector<std::string> unreached_texts(const LadderTask& task,
                                         const LadderChoice& choice,
                                         bool ranks_nothing);

}  // namespace glint
