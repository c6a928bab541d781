// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a part lies by its edges in several pictures: the views are rendered where it is known to
// lie, compared with the pictures, and rendered again from where these have it. Private to the
// room.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/config/keys.h"
#include "studies/definition/scene.h"
#include "studies/definition/study.h"

namespace glint::calibrate_cell_detail {

/// A picture of the part.
struct PartPhoto {
  std::string name;            ///< in the files that are written
  std::filesystem::path file;  ///< of the picture
  Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();  ///< mm
};

struct EdgePlacing {
  SceneSettings scene;  ///< see part_scene(); [cell.base_from_part] is where the search begins
  std::vector<PartPhoto> photos;
  std::filesystem::path calibration;  ///< folder of a calibration of a camera on the flange
  std::vector<KeyValue> sets;         ///< "place.key=value"
  int threads = 1;
};

/// What is left behind, each anew in every pass.
struct EdgeFiles {
  std::filesystem::path edges;      ///< .csv of seen points (studies/calibrate/place_file.h)
  std::filesystem::path poses;      ///< .toml of the pictures
  std::filesystem::path simulated;  ///< folder of the rendered views
  std::filesystem::path place;      ///< folder of `glint calibrate --place` of these
};

struct EdgePlacement {
  bool is_found = false;         ///< false: fewer than two pictures show enough of its edges
  int pictures = 0;              ///< that do
  int passes = 0;                ///< at most four; fewer where no edge moved by a tenth of a pixel
  nlohmann::ordered_json place;  ///< of place_part()
};

/// @throws ConfigError, IoError
EdgePlacement place_by_edges(const EdgePlacing& placing, const EdgeFiles& files);

}  // namespace glint::calibrate_cell_detail
