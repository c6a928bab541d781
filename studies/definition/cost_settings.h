// SPDX-License-Identifier: GPL-3.0-or-later
//
// [cost]: what a scan takes and what its lighting costs, so that time and price can be objectives.
#pragma once

#include <optional>

namespace glint {

/// What is not given is not known, and the scores that need it are unknown too.
struct CostSettings {
  std::optional<double> exposure_s;  ///< of one frame, > 0
  std::optional<double> move_s;      ///< from one position of the scan to the next, >= 0
  std::optional<double> per_mm2;     ///< of shining area, >= 0; the unit of money is the user's
  std::optional<double> per_led;     ///< >= 0
  std::optional<double> per_frame;   ///< >= 0
};

}  // namespace glint
