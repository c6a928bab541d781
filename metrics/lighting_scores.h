// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scores of the lighting itself, which follow from a scene's settings without a picture: how large
// it is, how long its scan takes and what it costs.
#pragma once

#include <optional>
#include <string_view>

#include "metrics/scores.h"

namespace glint {

/// What the lights that shine take and hold together.
struct LightingTotals {
  /// Of the box about their luminous surfaces. Empty: it has no end, or there is none.
  struct Size {
    double length_mm = 0.0;  ///< along x
    double width_mm = 0.0;   ///< along y
    double height_mm = 0.0;  ///< along z
    double area_mm2 = 0.0;   ///< of the surfaces
  };

  std::optional<Size> size;
  int leds = 0;
  int frames = 1;
  std::optional<double> scan_s;  ///< empty: [cost] does not tell
  std::optional<double> cost;    ///< likewise
};

/// What is known of it, under its names.
void add_scores(Scores& scores, const LightingTotals& totals);

/// Whether the score is of the lighting, its scan or its cost.
bool is_of_lighting(std::string_view name);

/// Whether the score needs lights that have an end, which an environment has not.
bool needs_light_size(std::string_view name);

}  // namespace glint
