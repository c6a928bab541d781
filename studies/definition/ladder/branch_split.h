// SPDX-License-Identifier: GPL-3.0-or-later
//
// A choice that changes a scene's kind: a mirror under a tunnel with one of its values, rough metal
// under a ring with another one. Each value has a ladder of its own (docs/accuracy.md, "Branches").
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/study.h"

namespace glint {

/// A choice with more values is not split: a trial of each would take too long.
inline constexpr std::size_t kMaxBranches = 8;

/// The values of a choice, each of which is a branch.
struct BranchSplit {
  std::size_t variable = 0;         ///< of the study's space
  std::string name;                 ///< of that variable
  std::vector<std::string> values;  ///< its choices, two or more

  /// The branch of a design. @param point  of the study's space, or one that begins so
  std::size_t branch_of(const Point& point) const;

  /// "lighting_use = ring"
  std::string label(std::size_t branch) const;
};

/// The choice of a study by which the baseline's ways to render differ in kind: closed forms,
/// paths, blurred reflections, sums of direct light. Of several the one with the most kinds, the
/// first of equal ones. Nothing where there is none; of a choice with a condition or with more than
/// kMaxBranches values; for a search by derivatives, which closed forms alone have.
std::optional<BranchSplit> branch_split(const Study& study);

/// The baseline with a branch's value.
Point baseline_of(const Study& study, const BranchSplit& split, std::size_t branch);

/// The branch of a prototype's values; empty: they are of none, as the variable cannot take that
/// value.
std::optional<std::size_t> branch_of(const Study& study,
                                     const BranchSplit& split,
                                     const Overrides& overrides);

/// The rungs that a search is rendered by: one, or one for each branch.
struct SearchRungs {
  std::optional<BranchSplit> split;
  std::vector<RenderRung> rungs;  ///< as many as the split has values; one without it

  const RenderRung& of(const Point& point) const;

  /// The rung's name; "ring: direct light, 8 samples; tunnel: ..." of several.
  std::string name() const;
};

}  // namespace glint
