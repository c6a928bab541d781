// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "defects/definition/defect_settings.h"

namespace glint {

/// One view on the page.
struct PageView {
  nlohmann::ordered_json row;  ///< of the result's `views`
  std::string png;             ///< picture and map
};

/// What the page of rendered views shows.
struct RenderPage {
  std::string title;
  nlohmann::ordered_json result;  ///< of render_views()
  std::vector<PageView> views;
  std::string sheet_png = {};       ///< all views, numbered; empty: one view
  std::set<DefectType> types = {};  ///< of the part's defects, for the legend
  std::string drawing;              ///< SVG
  std::string toml;
  nlohmann::ordered_json facts;  ///< scene_facts()
  std::string when;              ///< moment_text()
};

/// One HTML file that needs no network. Equal input gives equal bytes.
std::string render_page(const RenderPage& page);

}  // namespace glint
