// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "cli/acquire/acquire.h"
#include "cli/acquire/cell_calibration.h"

namespace CLI {
class App;
}  // namespace CLI

namespace glint {

/// --move, --twin, --speed_share and --confirmed of a verb that drives the robot.
/// @param when  "with --cell: " of a verb that can do without; else empty
void add_driving_options(CLI::App& verb, AcquireArguments& arguments, const std::string& when);

/// --mounted of a verb that takes pictures of a run's designs. With `when` it needs the verb's
/// --cell, which is there already.
void add_mounted_option(CLI::App& verb, AcquireArguments& arguments, const std::string& when);

/// Those of `glint calibrate --cell`, with driving and prototypes.
void add_cell_calibration(CLI::App& calibrate, CellCalibrationArguments& arguments);

}  // namespace glint
