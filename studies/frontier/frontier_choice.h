// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the program would take by itself of the rungs that a path-traced frontier has measured.
#pragma once

#include <string>

#include "studies/frontier/frontier.h"

namespace glint {

/// Errors that a choice without designs to put into order may have: those that `glint stability`
/// calls right.
inline constexpr double kChoicePoints = 0.5;    ///< of h, hundredths
inline constexpr double kChoiceContrast = 5.0;  ///< of the worst defect, per cent

/// Marks the automatic choice among the rungs of a path-traced scene (is_chosen): the cheapest that
/// puts the designs of a study into the right order, as [accuracy] has it; of a scene without them
/// the cheapest within kChoicePoints and kChoiceContrast. Mirrors have methods for it.
void mark_choice(Frontier& frontier);

/// What was chosen and by which rule, or that nothing is known to serve.
std::string choice_sentence(const Frontier& frontier);

}  // namespace glint
