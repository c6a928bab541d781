// SPDX-License-Identifier: GPL-3.0-or-later
//
// [accuracy]: how exactly the scores of a study must be known. The program chooses from it how
// scenes are rendered.
#pragma once

#include <string>
#include <vector>

namespace glint {

/// How wrong one score may be.
struct ScoreWish {
  std::string score;         ///< its full name, as "homogeneity.h_rms"
  double tolerance = 0.0;    ///< > 0; in the score's own unit, or a share of its value
  bool is_relative = false;  ///< written as "2 %"
};

struct AccuracySettings {
  bool is_auto = false;           ///< tolerance = "auto": the cheapest setting that ranks rightly
  std::vector<ScoreWish> wishes;  ///< in file order; empty with "auto"
  double confidence = 0.99;       ///< in [0.5, 1)
};

}  // namespace glint
