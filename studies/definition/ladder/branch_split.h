// SPDX-License-Identifier: GPL-3.0-or-later
//
// Choices that change a scene's kind: a mirror under a tunnel with one of their values, rough metal
// under a ring with another one. Each value, or each combination of the values of several, has a
// ladder of its own (docs/accuracy.md, "Branches").
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/study.h"

namespace glint {

/// A choice with more values makes no branches: a trial of each would take too long.
inline constexpr std::size_t kMaxBranchValues = 8;
/// Nor do further choices where there would be more combinations.
inline constexpr std::size_t kMaxBranches = 16;

/// A choice whose values make branches.
struct BranchChoice {
  std::size_t variable = 0;         ///< of the study's space
  std::string name;                 ///< of that variable
  std::vector<std::string> values;  ///< its choices, two or more
};

/// The branches of a study: all combinations of the values of some choices, the last one's running
/// fastest. From split_by().
struct BranchSplit {
  std::vector<BranchChoice> choices;  ///< one or more, in the order of the variables
  std::string name;                   ///< "lighting_use"; "lighting_use, material.type" of two
  std::vector<std::string> values;    ///< of each branch: "ring"; "ring, conductor" of two

  /// The branch of a design. @param point  of the study's space, or one that begins so
  std::size_t branch_of(const Point& point) const;

  /// Which of its values each choice has in a branch.
  std::vector<std::size_t> values_in(std::size_t branch) const;

  /// "lighting_use = ring"; "lighting_use = ring, material.type = conductor" of two
  std::string label(std::size_t branch) const;
};

/// @param choices  one or more, each with one value or more
BranchSplit split_by(std::vector<BranchChoice> choices);

/// The choices of a study by which the baseline's ways to render differ in kind: closed forms,
/// paths, blurred reflections, sums of direct light. First the one with the most kinds, the first
/// of equal ones; then, as long as there are no more than kMaxBranches, the one with the most kinds
/// in any of the branches so far, and so on. Nothing where there is none; no choice with a
/// condition or with more than kMaxBranchValues; nothing for a search by derivatives, which closed
/// forms alone have.
std::optional<BranchSplit> branch_split(const Study& study);

/// By the first of these choices alone: the branches of a search that was begun by kBranchRules.
std::optional<BranchSplit> one_choice_split(const Study& study);

/// Names of further choices that change how designs are rendered in kind and make no branches.
/// @param split  of the study, empty: it has one ladder
std::vector<std::string> choices_in_common(const Study& study,
                                           const std::optional<BranchSplit>& split);

/// A design with a branch's values.
Point in_branch(const Study& study, const BranchSplit& split, std::size_t branch, Point point);

/// The baseline with a branch's values.
Point baseline_of(const Study& study, const BranchSplit& split, std::size_t branch);

/// The branch of a prototype's values; empty: they are of none, as a variable cannot take its
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
