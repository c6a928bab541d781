// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scores that follow from a design alone and need no evaluation, like the size of a light.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "optimizer/problem/space.h"
#include "optimizer/problem/trial.h"

namespace glint {

struct ExactScores {
  std::vector<std::string> names;
  /// All of `names` at a canonical point, as an evaluation would give them; the same point gives
  /// the same bits. Throws glint::Error where the design cannot be built; a score that it has not
  /// (the size of lights none of which shines) is left out, and an evaluation fails there.
  std::function<Scores(const Point&)> at = {};
  /// >= 1. Of so many candidates of a question they may be told; counted, not timed, so that what
  /// is asked depends on no clock.
  int max_candidates = std::numeric_limits<int>::max();
};

}  // namespace glint
