// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/image/image.h"

namespace glint {

/// Pictures side by side, four in a row, each reduced to at most width_px.
/// @param pictures  of one size, at least one
ImageF contact_sheet(const std::vector<ImageF>& pictures, int width_px);

/// "picture_0007.png"
std::string trial_picture_name(int picture);

/// The first of the pictures in a trial's folder on one sheet. @throws IoError
ImageF shown_pictures(const std::filesystem::path& folder);

/// report.html of a trial. @param result  its result.json
std::string trial_page(const nlohmann::ordered_json& result,
                       const std::string& title,
                       const ImageF& sheet,
                       const std::string& config_toml);

}  // namespace glint
