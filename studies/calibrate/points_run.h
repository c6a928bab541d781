// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --points`: known points of the robot's cell drawn into its pictures.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "studies/calibrate/calibrate_input.h"

namespace glint {

struct NamedPoint {
  std::string name;
  Eigen::Vector3d base_mm = Eigen::Vector3d::Zero();  ///< in the robot's base
};

/// A table with the columns name, x_mm, y_mm, z_mm.
/// @throws ConfigError with file:line:column
std::vector<NamedPoint> parse_points(std::string_view text, const std::string& file);

/// Writes each picture with a cross at each point, under its own name as PNG, points.csv with their
/// pixels, and run.json.
/// @param options  pictures, poses (a camera on the flange needs them), camera: a calibration.json
/// or
///                 its folder, sets, out, threads
/// @return schema, status, pictures [{file, written, points [{name, pixel_px, is_in_picture}]}],
/// folder
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json draw_points(const std::filesystem::path& points,
                                   const CalibrateOptions& options);

}  // namespace glint
