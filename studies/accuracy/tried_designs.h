// SPDX-License-Identifier: GPL-3.0-or-later
//
// The designs that the ladder of a study's search is tried on, and the ladder itself.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "studies/definition/ladder/branch_split.h"
#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/study.h"

namespace glint {

/// How many designs a trial has.
inline constexpr std::size_t kTriedDesigns = 12;
/// How many each branch has, where a choice changes the scene's kind.
inline constexpr std::size_t kTriedOfBranch = 8;

/// A design that the ladder may be tried on.
struct TriedDesign {
  std::string name;
  Overrides overrides;
  std::optional<Point> point;  ///< of the search space; prototypes have none
};

/// What a ladder is tried on: the first of the candidates that can be evaluated.
struct TrialDesigns {
  std::vector<TriedDesign> candidates;
  std::size_t wanted = kTriedDesigns;
};

/// Four times as many as are tried, as some may be impossible: the baseline, up to eight
/// prototypes and a Sobol sequence over the variables.
std::vector<TriedDesign> tried_designs(const Study& study);

/// Of each branch, in their order: the baseline with the branch's values, its prototypes and the
/// points of the same sequence that lie in it.
std::vector<TrialDesigns> tried_designs(const Study& study, const BranchSplit& split);

/// The rungs that [accuracy] chooses from. is_for_search is false, too, of rungs without the
/// derivatives that the search needs. @param study  with a search
std::vector<RenderRung> search_ladder(const Study& study);

/// The rungs for the designs of a branch alone; those of the study's own scene where none of them
/// can be built.
std::vector<RenderRung> branch_ladder(const Study& study, const TrialDesigns& designs);

}  // namespace glint
