// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --cell`: plans poses, drives, photographs the board and calibrates, in rounds,
// until the calibration is good enough or no further pose helps.
//
//     DIR/round_1, round_2 ...  what `glint acquire` leaves: the cell's own views first, then poses
//                               that the calibration so far asks for
//     DIR/pictures, poses.toml  of all rounds, as `glint calibrate` reads them
//     DIR/plan_2 ...            `glint calibrate --plan` of each further round; tour.json has the
//                               poses and paths that were chosen, which a later call drives, too
//     DIR/calibration           `glint calibrate` of all pictures
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studies/acquire/acquire_run.h"
#include "studies/calibrate_cell/round_status.h"

namespace glint {

struct CalibrateOptions;

/// Of the pictures of all rounds so far: writes calibration.toml and calibration.json into the
/// options' `out` and returns what the latter holds.
using RoundCalibration = std::function<nlohmann::ordered_json(const CalibrateOptions&)>;

struct CalibrateCellOptions {
  AcquireOptions acquire;  ///< its `source` and `views` are not used; `out` is the whole folder
  std::filesystem::path board;  ///< board.toml or board.json, needed
  calibrate_cell_detail::RoundTargets targets;
  std::string setup = "eye_in_hand";  ///< or "eye_to_hand": the board is on the flange
  int poses_a_round = 8;
  int threads = 1;
  RoundCalibration calibrate = {};  ///< empty: calibrate_pictures()
};

/// Where results go: `out`, else out/<folder of the cell's file>/calibrate.
std::filesystem::path calibration_folder(const AcquireOptions& acquire);

/// Poses that are asked for are taken as `glint plan` takes views; where one is refused, the next
/// best takes its place.
/// @return {"status", "ok", "rounds": [...], "refused": [...], "calibration"}; status "good",
///         "no_pose_helps" (status_after_round(): pictures have hardly helped, and the next poses
///         promise hardly anything), "max_rounds" (all were used), "no_pose_reached" (each pose
///         that was asked for is refused), "no_picture" (all pictures of the last round were
///         rejected), "stopped", "waiting" (for a person who switches the "lights" in "next")
/// @throws ConfigError, IoError; what has been taken stays, and the same call goes on with it. Not
///         with a round that has not ended where something stands in its way by now, or an earlier
///         program chose its paths: ConfigError says what to remove
nlohmann::ordered_json calibrate_cell(const CalibrateCellOptions& options,
                                      const MotionPermit& permit);

}  // namespace glint
