// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint calibrate --place` is told of a part's place.
//
//   touched points  .csv: x_mm, y_mm, z_mm on the part, base_x_mm, base_y_mm, base_z_mm where the
//                   robot touched them, name (optional)
//   seen points     .csv: picture, x_mm, y_mm, z_mm on the part, u_px, v_px in the picture, name
//                   (optional); of a point on an edge also normal_u, normal_v, across the edge
//   board           .toml: [board_from_part] or [part_from_board], with sigma_mm and sigma_deg
//   placement       .toml: [cell.base_from_part] or [cell.flange_from_part], as an earlier one
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/placement/part_placement.h"
#include "studies/definition/cell_settings.h"

namespace glint {

struct TouchedPoints {
  std::vector<std::string> names;
  std::vector<Eigen::Vector3d> part_mm;
  std::vector<Eigen::Vector3d> base_mm;  ///< same length
};

struct SeenPoint {
  std::string name;
  std::string picture;
  Eigen::Vector3d part_mm = Eigen::Vector3d::Zero();
  Eigen::Vector2d pixel_px = Eigen::Vector2d::Zero();
  std::optional<Eigen::Vector2d> normal;  ///< unit; only the distance along it is known
};

struct BoardOffset {
  Eigen::Isometry3d board_from_part = Eigen::Isometry3d::Identity();
  Matrix6d board_covariance = Matrix6d::Zero();  ///< of an increment in the board's frame
  Matrix6d part_covariance = Matrix6d::Zero();   ///< of one in the part's frame
};

struct EarlierPlacement {
  PlacedPart placed;
  bool is_on_flange = false;
};

using PlaceFile =
    std::variant<TouchedPoints, std::vector<SeenPoint>, BoardOffset, EarlierPlacement>;

/// @param ending  ".csv" or ".toml"
/// @throws ConfigError with file:line:column
PlaceFile parse_place_file(std::string_view text, const std::string& file, std::string_view ending);

/// @throws ConfigError, IoError
PlaceFile read_place_file(const std::filesystem::path& file);

/// The pose with the roots of the variances.
MeasuredPoseSettings measured_pose(const PlacedPart& placed);

}  // namespace glint
