// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <string>

#include "studies/report/report_wording.h"

namespace glint::report_detail {

/// Of a difference of a score: shares are read in points.
inline std::string error_text(const std::string& score, double value) {
  return (value < 0.0 ? "\u2212" : "") + Wording::of_score(score).size(std::abs(value));
}

}  // namespace glint::report_detail
