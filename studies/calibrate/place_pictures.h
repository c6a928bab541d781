// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the part is by pictures of a calibrated camera: of its points and edges, of a board on it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "studies/calibrate/calibrate_input.h"
#include "studies/calibrate/place_file.h"

namespace glint {

/// One placement and what is told of it.
struct Placement {
  PlacedPart placed;
  bool is_on_flange = false;
  nlohmann::ordered_json told;
  std::string why_unknown;  ///< why the covariance is not stated, then 0; empty: nothing to add
};

/// Without a guess where the part is.
/// @param file      for messages
/// @param options   camera, poses, sets of poses
/// @param sigma_px  of a point along one axis; 0: from what remains
/// @throws ConfigError where the points leave the place open, IoError
Placement place_by_seen_points(const std::vector<SeenPoint>& points,
                               const std::filesystem::path& file,
                               const CalibrateOptions& options,
                               double sigma_px);

/// @param options  as above; pictures of the board on the part, none: it lies as in the calibration
/// @throws ConfigError, IoError
Placement place_by_seen_board(const BoardOffset& offset, const CalibrateOptions& options);

}  // namespace glint
