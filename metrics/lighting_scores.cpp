// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/lighting_scores.h"

namespace glint {

void add_scores(Scores& scores, const LightingTotals& totals) {
  if (totals.size) {
    scores["lighting.width_mm"] = totals.size->width_mm;
    scores["lighting.height_mm"] = totals.size->height_mm;
    scores["lighting.length_mm"] = totals.size->length_mm;
    scores["lighting.area_mm2"] = totals.size->area_mm2;
  }
  scores["lighting.leds"] = totals.leds;
  scores["scan.frames"] = totals.frames;
  if (totals.scan_s) {
    scores["scan.time_s"] = *totals.scan_s;
  }
  if (totals.cost) {
    scores["cost.total"] = *totals.cost;
  }
}

bool is_of_lighting(std::string_view name) {
  return name.starts_with("lighting.") || name.starts_with("scan.") || name.starts_with("cost.");
}

bool needs_light_size(std::string_view name) {
  return name.starts_with("lighting.") && name != "lighting.leds";
}

}  // namespace glint
