// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint undistort`: pictures as a camera without distortion would have taken them.
#pragma once

#include <filesystem>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace glint {

struct UndistortOptions {
  std::vector<std::filesystem::path> pictures;
  std::filesystem::path camera;  ///< calibration.toml, or a camera's file of others
  std::filesystem::path out;     ///< empty: out/<the pictures' folder>/undistort
  int threads = 1;
};

/// Writes each picture as PNG with 8 or 16 bits, or as OpenEXR when its values are floats, under
/// its own name; colour becomes luminance. camera.toml is the camera of the new pictures.
/// @return schema, status, pictures [{file, written}], outside_share, camera, folder
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json undistort_pictures(const UndistortOptions& options);

}  // namespace glint
