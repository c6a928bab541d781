// SPDX-License-Identifier: GPL-3.0-or-later
//
// The designs that the ladder of a study's search is tried on, and the ladder itself.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/study.h"

namespace glint {

/// How many designs a trial has.
inline constexpr std::size_t kTriedDesigns = 12;

/// A design that the ladder may be tried on.
struct TriedDesign {
  std::string name;
  Overrides overrides;
  std::optional<Point> point;  ///< of the search space; prototypes have none
};

/// Four times as many as are tried, as some may be impossible: the baseline, up to eight
/// prototypes and a Sobol sequence over the variables.
std::vector<TriedDesign> tried_designs(const Study& study);

/// The rungs that [accuracy] chooses from. is_for_search is false, too, of rungs without the
/// derivatives that the search needs. @param study  with a search
std::vector<RenderRung> search_ladder(const Study& study);

}  // namespace glint
