// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/placement_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/shell/note_lines.h"

namespace glint {

std::string placed_part_text(const nlohmann::ordered_json& result,
                             const std::string& name,
                             const std::string& file) {
  const nlohmann::ordered_json& pose = result[name];
  const nlohmann::ordered_json& spread = result["spread"];
  const nlohmann::ordered_json& at = pose["translation_mm"];
  std::string text = fmt::format("{}: {:.3f} {:.3f} {:.3f} mm",
                                 name,
                                 at[0].get<double>(),
                                 at[1].get<double>(),
                                 at[2].get<double>());
  text += pose["sigma_mm"].is_null() ? std::string(", how well known is not stated\n")
                                     : fmt::format(" +- {:.2g} mm, {:.2g} degrees\n",
                                                   pose["sigma_mm"].get<double>(),
                                                   pose["sigma_deg"].get<double>());
  if (!spread.is_null()) {
    text += fmt::format("placements differ by {:.2g} mm, {:.2g} degrees (standard deviation)\n",
                        spread["mm"].get<double>(),
                        spread["deg"].get<double>());
  }
  return text + note_lines(result["notes"]) + fmt::format("part for scenes: {}\n", file);
}

}  // namespace glint
