// SPDX-License-Identifier: GPL-3.0-or-later
//
// Designs that promise to be good although they are not built exactly: Gaussian processes of the
// search's scores, asked at the built designs. They only propose.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "optimizer/problem/goal.h"
#include "optimizer/problem/space.h"
#include "optimizer/problem/trial.h"
#include "optimizer/robust/built_merit.h"
#include "optimizer/search/expectations.h"
#include "optimizer/search/expected_limits.h"

namespace glint {

/// What makes a design robust.
struct RobustTask {
  const SearchSpace& space;
  const Goal& goal;
  std::span<const Trial> trials;  ///< of the search
  /// What building adds to the variables, one row a built design; 0 where a variable has no
  /// tolerance, all 0 where keys have one that are no variables.
  std::vector<Point> offsets;
  bool is_noisy = false;  ///< of the search: scores of one design vary
  std::uint64_t seed = 1;
  FrontRows front = {};           ///< as of BuiltMerit
  Expectations expected = {};     ///< of noisy objectives: what counts of trials instead of scores
  LimitExpectations limits = {};  ///< the same of limits
};

struct Proposal {
  Point point;
  double modelled = 0.0;  ///< the merit that the models expect 95 % of the built designs to reach
};

/// The `count` best ones by the models that lie apart from `winner` and from each other: trials,
/// even points of the space, and what is found about the best of these. The first half takes the
/// models at their word, the second keeps limits by two standard deviations of them. Fewer where
/// there are no more, none where fewer than three trials succeeded. Deterministic.
/// @param winner  of the search, canonical
std::vector<Proposal> propose_robust(const RobustTask& task, const Point& winner, int count);

}  // namespace glint
