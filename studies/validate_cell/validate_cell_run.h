// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint validate --cell`: the robot takes the pictures of a run's designs, one design after the
// other, and then both sides are compared.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "hardware/robot/motion_permit.h"
#include "studies/acquire/acquire_run.h"
#include "studies/validate/validate_run.h"

namespace glint {

struct ValidateCellOptions {
  /// Its `pictures` is where they go, a folder for each design; empty: beside the run, "acquired".
  ValidateOptions validate;
  AcquireOptions acquire;  ///< all but source and out, which are each design's
};

/// What the folders have already is not taken again: after an interruption it goes on. Designs
/// whose prototypes are mounted come first; the next one waits for a person as in
/// acquire_pictures().
/// A design of which the arm gets to no view is left out, as is one whose pictures were all
/// rejected; others go on.
/// @return what validate_run() returns, or, where a design's acquisition was stopped or waits, or
///         no design has an accepted picture, what acquire_pictures() told of it with "design" and
///         "agreement" null
/// @throws ConfigError before anything has moved, IoError
nlohmann::ordered_json validate_in_cell(const ValidateCellOptions& options,
                                        const MotionPermit& permit);

}  // namespace glint
