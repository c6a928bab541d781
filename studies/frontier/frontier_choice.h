// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which of the rungs that a path-traced frontier has measured [accuracy] would take by what the
// frontier knows of them (docs/frontier.md, "The automatic choice").
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/study.h"
#include "studies/frontier/frontier.h"

namespace glint {

/// Errors that a choice without designs to put into order may have: those that `glint stability`
/// calls right.
inline constexpr double kChoicePoints = 0.5;    ///< of h, hundredths
inline constexpr double kChoiceContrast = 5.0;  ///< of the worst defect, per cent

/// Sets the branches of the study's search (docs/accuracy.md, "Branches") and that of its scene:
/// the order of designs and the choice are those of this branch, as a run's are.
void find_branch(const Study& study, Frontier& frontier);

/// The rungs that [accuracy] chooses from in the study, or would with that table: of the scene's
/// branch, where the search has some, and none where the scene lies in none of them. Of a scene
/// without a search those of its own ladder. @param frontier  after find_branch()
std::vector<RenderRung> choice_ladder(const Study& study, const Frontier& frontier);

/// The study's goal with the scores that [accuracy] names: without limits, they are scored alone.
Goal choice_goal(const Study& study);

/// Marks the automatic choice among the points of a path-traced scene (is_chosen) and sets
/// choice_rule. Only rungs of the ladder that a search may take are marked: of those that serve the
/// one of the least counted work. With tolerances in [accuracy] those serve whose own errors are
/// within all of them; else those that put the designs of a study into the right order; of a scene
/// without designs those within kChoicePoints and kChoiceContrast. Mirrors have no such mark.
void mark_choice(std::span<const RenderRung> ladder,
                 const std::optional<AccuracySettings>& accuracy,
                 Frontier& frontier);

/// The same by the study's own ladder and [accuracy]. @param frontier  after find_branch()
void mark_choice(const Study& study, Frontier& frontier);

/// What was chosen and by which rule, or that nothing is known to serve. After mark_choice().
std::string choice_sentence(const Frontier& frontier);

}  // namespace glint
