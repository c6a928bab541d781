// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --place`: where the part is in the robot's base, for scenes.
#pragma once

#include <filesystem>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/calibrate/calibrate_input.h"

namespace glint {

/// What tells of one placement.
struct PlaceInput {
  std::filesystem::path file;                ///< see place_file.h
  std::vector<std::filesystem::path> poses;  ///< of its pictures; empty: those of the options
};

/// Writes placement.toml, whose table [cell] scenes take by include, placement.json and run.json.
/// Several files are several placements of a part that was taken away and put back: their mean
/// counts, and how far they lie apart says how well the next one is known.
/// @param inputs   at least one
/// @param options  camera: a calibration.json or its folder, of which points in pictures and boards
///                 need one; poses: where a camera on the flange took them from; pictures of the
///                 board on the part, none: it lies as in the calibration; board: another one than
///                 the calibration's; sets: place.sigma_mm, place.sigma_px and those of poses
/// @return schema, status, base_from_part or flange_from_part {from, to, rotation_vector_rad,
///         translation_mm, sigma_deg, sigma_mm, covariance}, placements [{file, by, rms_mm or
///         rms_px, points}], spread, notes, folder
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json place_part(const std::vector<PlaceInput>& inputs,
                                  const CalibrateOptions& options);

}  // namespace glint
