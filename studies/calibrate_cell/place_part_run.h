// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --cell --part`: where the part lies in the cell and how well it lies there when
// it is put back, from edges in pictures that the robot takes of it.
//
//     DIR/part/scene.toml        the part's scene with the calibrated camera
//     DIR/part/placed.json       the placement that a person has put the part down for last
//     DIR/part/placement_1 ...   what `glint acquire` leaves, of each time
//     DIR/part/edges_1.csv, poses_1.toml ...   what of these `glint calibrate --place` reads
//     DIR/part/found_1.json ...  where it was found then, in which scene and pictures
//     DIR/part/simulated_1, place_1 ...   the same views rendered, and each placement's own result
//     DIR/place                  `glint calibrate --place` of all: placement.toml for scenes
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "studies/acquire/acquire_run.h"

namespace glint {

struct PlacePartOptions {
  AcquireOptions acquire;  ///< its `source` and `views` are not used; `out` is the whole folder
  std::filesystem::path scene;        ///< part, lights, views, [cell.base_from_part] about right
  std::filesystem::path calibration;  ///< folder of a calibration of a camera on the flange
  int placements = 1;                 ///< >= 1; how many times the part is put down
  int placed = 0;  ///< number of the placement that a person says is done; 0: none
  int threads = 1;
};

/// Each placement is one that a person confirms, by `placed` or `acquire.confirm`; none is assumed.
/// Nor is it that the scene's lights are mounted where it belongs to a run whose designs have
/// others (MountedPrototypes): `acquire.mounted` or `acquire.confirm` says so. What is there is not
/// taken again; where the folder of a placement has been removed, its part has to be put down anew.
/// @return {"status": "placed" | "waiting" | "stopped" | "too_few_pictures", "ok", "folder",
///         "placements": [...], "next", "end", "base_from_part", "spread", "placement"}
/// @throws ConfigError, IoError; what has been taken stays, and the same call goes on with it
nlohmann::ordered_json place_part_in_cell(const PlacePartOptions& options,
                                          const MotionPermit& permit);

}  // namespace glint
