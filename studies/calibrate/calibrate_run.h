// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate`: a real camera from pictures of a board, on or beside a robot where there are
// its poses.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "studies/calibrate/calibrate_input.h"

namespace glint {

/// Writes calibration.toml, calibration.json, corners.csv, report.html and run.json; and, from
/// which with the corners all can be computed again, board.toml, with poses poses.toml (of the
/// flange, in the pictures' order), with a known camera known_camera.toml. Where options.from is a
/// folder with them, they are taken for what is not given.
/// @return what calibration.json holds, "report" and "folder"
/// @throws ConfigError for wrong input and for pictures that do not suffice, IoError; nothing is
///         left behind
nlohmann::ordered_json calibrate_pictures(const CalibrateOptions& given);

}  // namespace glint
