// SPDX-License-Identifier: GPL-3.0-or-later
//
// A calibration as text: calibration.json, and calibration.toml for scenes to include.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studies/calibrate/calibrate_input.h"
#include "studies/calibrate/solved_calibration.h"

namespace glint {

/// What calibration.json holds (docs/calibrate.md); numbers that are not known are null.
nlohmann::ordered_json calibration_json(const CalibrateInput& input,
                                        const SolvedCalibration& solved);

/// Tables that a scene takes: [camera] with the calibrated intrinsics alone, [calibration] with the
/// hand-eye and the covariances.
std::string calibration_toml(const CalibrateInput& input, const SolvedCalibration& solved);

}  // namespace glint
