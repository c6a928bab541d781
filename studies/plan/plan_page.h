// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/image/image_io.h"

namespace glint {

/// "11 of 12 views can be taken, nothing comes nearer than 7.3 mm; the tour takes 48 s."
std::string plan_sentence(const nlohmann::ordered_json& plan);

/// What the page of `glint plan` shows.
struct PlanPage {
  std::string title;
  const nlohmann::ordered_json& plan;  ///< plan_json()
  const ImageRgb& sheet;               ///< arm and cell at each planned view
  std::string toml;
  std::string when;  ///< moment_text()
};

/// One HTML file that needs no network. Equal input gives equal bytes.
std::string plan_page(const PlanPage& page);

}  // namespace glint
