// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/error.h"

namespace glint {

/// The middle value; of an even number of values the mean of the two middle ones.
/// @param values  not empty
inline double median(std::vector<double> values) {
  GLINT_CHECK(!values.empty(), "values to take the median of");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return values.size() % 2 == 1 ? *middle
                                : 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace glint
