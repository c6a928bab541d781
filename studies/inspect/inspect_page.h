// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page of `glint inspect`: one HTML file that needs no network.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studies/inspect/inspected_part.h"

namespace glint {

/// A part's picture for the page: base64 of an 8-bit PNG.
std::string page_picture(const ImageF& shown);

/// More parts are in the table only.
inline constexpr std::size_t kMaxPagePictures = 100;

/// @param result    the object of result.json
/// @param pictures  of the first parts, by page_picture()
/// @param toml      the settings
std::string inspect_page(const nlohmann::ordered_json& result,
                         std::span<const InspectedPart> parts,
                         std::span<const std::string> pictures,
                         const InspectionSettings& settings,
                         const std::string& toml);

}  // namespace glint
