// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --place SCENE PICTURES...`: where the part of a scene lies by its edges in
// pictures that lie in a folder; no cell and no robot are needed.
//
//     DIR/placement.toml, placement.json   as of every `glint calibrate --place`
//     DIR/edges.csv, poses.toml            what these are made from
//     DIR/simulated                        the views, rendered where the part was found
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "studies/calibrate/calibrate_input.h"

namespace glint {

/// Whether a file describes a scene with a part, as opposed to what tells a place by itself
/// (studies/calibrate/place_file.h). @throws IoError, ConfigError for TOML that is none
bool is_part_scene(const std::filesystem::path& file);

/// @param scene    part, lights, and [cell.base_from_part] about where it lies
/// @param options  pictures, poses, camera (folder of a calibration of a camera on the flange),
///                 sets "place.", "convention.", "poses.", out, threads
/// @return what place_part() returns, and "passes"
/// @throws ConfigError: what is missing or does not fit; too few pictures show the part. IoError
nlohmann::ordered_json place_scene_part(const std::filesystem::path& scene,
                                        const CalibrateOptions& options);

}  // namespace glint
