// SPDX-License-Identifier: GPL-3.0-or-later
//
// The design that promises most, by rules 2: even and local candidates, of which the best few that
// lie apart climb the derivatives of the promise over their continuous variables, all at once
// (Rprop: M. Riedmiller and H. Braun, IEEE ICNN 1993; signs of derivatives only, so nothing depends
// on scales).
#pragma once

#include <array>
#include <optional>
#include <set>
#include <vector>

#include "core/rng.h"
#include "optimizer/algorithm/exact_values.h"
#include "optimizer/algorithm/promise.h"
#include "optimizer/problem/space.h"
#include "optimizer/surrogate/encoding.h"

namespace glint {

/// Widths of neighbour(), as parts of a variable's range: of candidates around the best design, and
/// of rounds around the most promising candidate.
inline constexpr std::array<double, 2> kLocalWidths = {0.15, 0.03};
inline constexpr std::array<double, 3> kRefinedWidths = {0.1, 0.03, 0.01};

/// Numbers are moved by a normal step, choices drawn anew. @param is_sparse  only some variables
Point neighbour(
    const SearchSpace& space, const Point& point, double width, bool is_sparse, Rng& rng);

/// Fully climbed, what promises most in many variables is some corner of the cube that no design is
/// near, again and again; so most questions stay near what is known to be good.
enum class Reach {
  kEverywhere,  ///< candidates all over the space, climbs without end
  kNear         ///< candidates around the best designs, short climbs
};

/// All of it must outlive the call.
struct ProposalTask {
  const SearchSpace& space;
  const Promise& promise;
  const Encoding& encoding;
  const std::vector<Point>& known;     ///< what the promise's first model knows, in its order
  const std::set<Point>& asked;        ///< never proposed
  const ExactValues* exact = nullptr;  ///< nullptr: nothing follows from a design alone
};

/// With exact values the models choose the candidates that are worth them, and climbs follow the
/// models, moved to the exact value where they start; who is best is told by exact values alone.
/// @return empty: all candidates have been asked before
std::optional<Point> propose(const ProposalTask& task, Reach reach, Rng& rng);

}  // namespace glint
