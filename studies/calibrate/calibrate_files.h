// SPDX-License-Identifier: GPL-3.0-or-later
//
// A calibration as text: calibration.json, and calibration.toml for scenes to include.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "studies/calibrate/calibrate_input.h"
#include "studies/calibrate/solved_calibration.h"

namespace glint {

/// What became of a picture without corners: "cut off: 37 of 63 corners found".
std::string reason_of_view(const BoardView& view);

/// Why a picture does not take part in the calibration; empty when it does.
std::string reason_of(const CalibrateInput& input,
                      const SolvedCalibration& solved,
                      std::size_t picture);

/// What calibration.json holds (docs/calibrate.md); numbers that are not known are null.
/// @param residuals_px  corner_residuals_px()
nlohmann::ordered_json calibration_json(
    const CalibrateInput& input,
    const SolvedCalibration& solved,
    const std::vector<std::vector<Eigen::Vector2d>>& residuals_px);

nlohmann::ordered_json vector_json(const Eigen::Vector3d& v);

/// A known camera's intrinsics as a file for --camera.
std::string known_camera_toml(const CalibrateInput& input);

/// Tables that a scene takes: [camera] with the calibrated intrinsics alone, [calibration] with the
/// hand-eye and the covariances.
std::string calibration_toml(const CalibrateInput& input, const SolvedCalibration& solved);

}  // namespace glint
