// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/cover/cover_pictures.h"

namespace glint {

/// What the page of `glint cover` shows.
struct CoverPage {
  std::string title;
  const nlohmann::ordered_json& result;  ///< coverage_json()
  const std::vector<LegendEntry>& legend;
  const std::vector<CoveragePicture>& pictures;
  std::string toml;
  std::string when;  ///< moment_text()
};

/// One HTML file that needs no network. Equal input gives equal bytes.
std::string cover_page(const CoverPage& page);

/// "98.2 % of the surface is inspected by 12 views, ..."
std::string coverage_sentence(const nlohmann::ordered_json& result);

}  // namespace glint
