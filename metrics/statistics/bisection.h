// SPDX-License-Identifier: GPL-3.0-or-later
//
// The smallest thing that is found: where a rising figure reaches a target.
#pragma once

#include <functional>

namespace glint {

enum class Detectable {
  kFound,    ///< the target is reached inside the range
  kAlready,  ///< at the low end already: the answer is at or below it
  kNever     ///< not even at the high end: the answer is above it
};

struct SmallestDetectable {
  Detectable result = Detectable::kNever;
  double size = 0.0;       ///< reaches the target (kNever: the high end, which does not)
  double statistic = 0.0;  ///< there
};

struct BisectionSettings {
  double relative_step = 0.01;  ///< > 0; stops when the range is this narrow
  int max_calls = 40;           ///< >= 3; and at the latest after so many figures
};

/// Bisects ln(size) between two sizes. Of a figure that does not rise throughout it finds one
/// crossing of the target. A noisy figure must be asked with common random numbers.
/// @param statistic  of a size; d' or a probability
/// @param low, high  0 < low < high
SmallestDetectable smallest_detectable(const std::function<double(double)>& statistic,
                                       double low,
                                       double high,
                                       double target,
                                       const BisectionSettings& settings = {});

}  // namespace glint
