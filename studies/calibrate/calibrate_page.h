// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page of `glint calibrate`: one HTML file that needs no network.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "studies/calibrate/calibrate_input.h"
#include "studies/calibrate/solved_calibration.h"

namespace glint {

/// @param result        calibration_json()
/// @param residuals_px  corner_residuals_px()
/// @param when          date and duration
std::string calibrate_page(const nlohmann::ordered_json& result,
                           const CalibrateInput& input,
                           const SolvedCalibration& solved,
                           const std::vector<std::vector<Eigen::Vector2d>>& residuals_px,
                           const std::string& when);

}  // namespace glint
