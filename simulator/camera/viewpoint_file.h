// SPDX-License-Identifier: GPL-3.0-or-later
//
// Viewpoints as nine numbers each: position, direction, up. Read from TOML, CSV and JSON.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/camera/camera_settings.h"

namespace glint {

/// (position x, y, z in mm, direction x, y, z, up x, y, z).
using ViewpointVector = std::array<double, 9>;

ViewpointVector vector_of(const Viewpoint& viewpoint);

/// The same view with direction and up as unit vectors; vectors that are units already keep their
/// bits. @throws ConfigError when a number is not finite, or up is zero or parallel to direction
Viewpoint normalised(const Viewpoint& viewpoint);

/// The viewpoints of a list: each item a table (position_mm, direction, up) or nine numbers.
/// Normalised. Problems are appended to errors with their places, and that item left out.
std::vector<Viewpoint> read_viewpoint_list(const ConfigNode& list, std::vector<Problem>& errors);

/// Nine numbers a line, with commas; lines that begin with '#' and empty lines do not count. A head
/// line, when there is one, must name the columns: position_x_mm, position_y_mm, position_z_mm,
/// direction_x to _z, up_x to _z.
/// @param file  for messages
/// @throws ConfigError with file:line:column, one line per problem
std::vector<Viewpoint> parse_viewpoints_csv(std::string_view text, const std::string& file);

/// A list of items as in read_viewpoint_list(), or an object with that list as "viewpoint".
/// @throws ConfigError with file:line:column
std::vector<Viewpoint> parse_viewpoints_json(std::string_view text, const std::string& file);

/// By the file's ending: .toml ([[viewpoint]]), .csv, .json. At least one viewpoint.
/// @throws ConfigError (with places), IoError
std::vector<Viewpoint> read_viewpoints(const std::filesystem::path& path);

}  // namespace glint
