// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --cell`: its arguments, and what is told of its result.
#pragma once

#include <filesystem>

#include "cli/acquire/acquire.h"

namespace glint {

struct CellCalibrationArguments {
  AcquireArguments acquire;  ///< its cell, twin, out, --move and --confirmed
  std::filesystem::path board;
  double target_px = 0.3;
  int threads = 1;
};

/// @throws ConfigError without --move, before any file is read and any address is looked up
AcquireAnswer run_cell_calibration(const CellCalibrationArguments& arguments, bool is_silent);

}  // namespace glint
