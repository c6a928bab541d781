// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint check` says where a budget of time ends a search before its rung lets it do its work.
#pragma once

#include <string>

#include "studies/accuracy/chosen_accuracy.h"

namespace glint {

/// Fewer evaluations are no search: that many are wanted where a budget sets no number.
inline constexpr int kMinEvaluations = 20;

/// A tolerance that is not reachable within the budget, with the bound that is: that of the dearest
/// rung of those tried by which as many evaluations fit as are wanted, by counted work. Where
/// branches have rungs of their own, the branch that saves the most work goes down first. Empty
/// where the chosen rungs let all of them be made. It chooses nothing: no clock has a say in that.
/// @param possible  evaluations at the chosen rung that fit into the budget of time
std::string budget_note(const Study& study, const ChosenAccuracy& chosen, int possible);

}  // namespace glint
