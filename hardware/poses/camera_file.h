// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cameras that somebody has calibrated already, from files of others: TOML with the table [camera]
// and, where a scene has it, [lens]; OpenCV's and ROS's YAML, OpenCV's and ViSP's XML.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

#include "simulator/camera/pinhole_camera.h"

namespace glint {

/// A camera's file, with what is told of it.
struct CameraFile {
  PinholeIntrinsics intrinsics;  ///< size 0 x 0 where the file does not tell it
  std::string kind;              ///< "TOML", "OpenCV or ROS", "ViSP"
  /// Where a TOML file's [lens] with f_number shows all sharp to one pixel; not told: everywhere.
  double sharp_near_mm = 0.0;
  double sharp_far_mm = std::numeric_limits<double>::infinity();
};

/// Pixels are counted Glint's way when they come out: OpenCV, ROS and ViSP put the centre of the
/// first pixel at (0, 0), so half a pixel is added to their principal points. ViSP's kud is k1 (the
/// higher terms of its model are 0), kdu, its inverse, is not used.
/// @param ending  ".toml", ".yaml", ".yml" or ".xml"
/// @throws ConfigError with file:line:column: keys that are missing or of the wrong kind, a matrix
/// with skew, distortion beyond k1 k2 p1 p2 k3, fisheye models
CameraFile parse_camera_file(std::string_view text,
                             const std::string& file,
                             std::string_view ending);

/// By the file's ending. @throws ConfigError, IoError
CameraFile read_camera_file(const std::filesystem::path& path);

}  // namespace glint
