// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --check`: whether a calibration still holds for new pictures of its board.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "studies/calibrate/calibrate_input.h"

namespace glint {

/// With poses, where the calibration has a hand-eye: every corner is computed from the robot's pose
/// alone. Without: each picture gets a pose of its own. Writes nothing.
/// @param options  pictures, poses, sets, threads; board: empty takes the calibration's
/// @return schema, status "valid", "drifted" or, with poses where the calibration does not know how
///         well they predict, "not_judged"; by "prediction" or "reprojection", rms_px, expected_px,
///         limit_px, drift_px (null where not judged), mean_px, board_moved, pictures, notes
/// @throws ConfigError, IoError
nlohmann::ordered_json check_calibration(const std::filesystem::path& calibration,
                                         const CalibrateOptions& options);

}  // namespace glint
