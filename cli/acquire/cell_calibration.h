// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --cell`: its arguments, and what is told of its result.
#pragma once

#include <filesystem>
#include <string>

#include "cli/acquire/acquire.h"

namespace glint {

struct CellCalibrationArguments {
  AcquireArguments acquire;     ///< its cell, twin, out, --move and --confirmed
  std::filesystem::path board;  ///< empty: --part with a calibration that is there
  std::string setup;            ///< empty: eye_in_hand
  double target_px = 0.3;
  double target_mm = 0.0;  ///< of the hand-eye's stated sigma; 0: not asked for
  double target_deg = 0.0;
  int max_rounds = 4;
  std::filesystem::path part;    ///< scene of the part to be placed; empty: none
  std::filesystem::path camera;  ///< folder of a calibration, instead of the board's
  int placements = 1;
  int placed = 0;  ///< number of the placement that a person says is done; 0: none
  int threads = 1;
};

/// @throws ConfigError without --move, before any file is read and any address is looked up
AcquireAnswer run_cell_calibration(const CellCalibrationArguments& arguments, bool is_silent);

}  // namespace glint
