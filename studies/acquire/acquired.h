// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint acquire` leaves in its folder, as others read it.
//
//     acquired.json             this, whole or not at all
//     poses.csv                 a line a picture, for `glint calibrate --poses`
//     views/NAME/sequence/      the pictures of a view: frame_000.png ...
//     views/NAME/aspect.png     their mean
//     rejected/NAME/            pictures that were not kept
//     scene.toml, cell.toml, calibration.toml   where there are any
//     journal.sqlite            what has been taken (journal.h)
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "hardware/robot/kinematics/denavit_hartenberg.h"

namespace glint {

/// One picture with everything that is known of it.
struct AcquiredPicture {
  std::string view;
  int position = 0;                 ///< of the scan's sequence; 0 without one
  std::vector<std::string> lights;  ///< that were on
  std::string file;                 ///< below the folder
  bool is_accepted = true;
  std::string reason;                                                  ///< why not
  Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();  ///< mm
  JointVector joints_rad = JointVector::Zero();
  double position_sigma_mm = 0.0;   ///< of base_from_flange, along each axis
  double rotation_sigma_rad = 0.0;  ///< about each
  double exposure_us = 0.0;
  std::optional<double> gain_db;   ///< none: the cell says none in dB
  std::optional<double> stage_mm;  ///< none: there is no stage, or it is no linear one
  std::uint64_t frame_id = 0;
  std::uint64_t camera_time_ns = 0;
  double host_time_s = 0.0;  ///< since 1970
  double sharpness = 0.0;    ///< PictureFigures
  std::string sha256;        ///< of the file
};

struct Acquired {
  std::filesystem::path folder;
  std::string status;           ///< "complete", "partial", "stopped"
  std::filesystem::path scene;  ///< with the folder; empty: none
  std::filesystem::path cell;
  std::filesystem::path calibration;  ///< empty: none
  bool is_twin = false;
  std::vector<AcquiredPicture> pictures;  ///< in the order of views and positions

  /// Accepted pictures of a view, by rising positions.
  std::vector<AcquiredPicture> of_view(const std::string& view) const;

  /// Names of views with at least one accepted picture, in order.
  std::vector<std::string> views() const;

  /// views/NAME/aspect.png
  std::filesystem::path aspect_of(const std::string& view) const;
};

/// A picture's object in acquired.json, and back. @throws ConfigError for one that is none
nlohmann::ordered_json picture_json(const AcquiredPicture& picture);
AcquiredPicture picture_of_json(const nlohmann::ordered_json& json);

/// Reads acquired.json of a folder. @throws IoError; ConfigError for a file that is none
Acquired read_acquired(const std::filesystem::path& folder);

/// A view's name as a folder has it: letters, digits, '_', '-' and '.'; others become '_'.
std::string folder_name_of(const std::string& view);

}  // namespace glint
