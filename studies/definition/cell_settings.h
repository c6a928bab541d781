// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tables that join a scene to a real camera and robot: [calibration], [cell], [reference].
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/config/keys.h"
#include "core/config/pose_keys.h"

namespace glint {

/// Where the camera is fixed.
enum class CalibrationSetup {
  kNone,       ///< not told: a camera without a robot
  kEyeInHand,  ///< on the flange
  kEyeToHand   ///< beside the robot, in the frame of its base
};

/// Keys of [calibration.covariance], symmetric matrices row by row up to the diagonal. Empty: not
/// known.
struct CovarianceSettings {
  std::vector<double> intrinsics;  ///< 45: of fx fy cx cy k1 k2 k3 p1 p2
  std::vector<double> hand_eye;    ///< 21: of rotation (rad), then position (mm)
  std::vector<double> cross;       ///< 54: 6 rows of hand-eye by 9 columns of intrinsics

  bool is_empty() const { return intrinsics.empty() && hand_eye.empty() && cross.empty(); }
};

/// Keys of [calibration]: what is known of the camera that [camera] describes.
struct CalibrationSettings {
  CalibrationSetup setup = CalibrationSetup::kNone;
  std::optional<MeasuredPoseSettings> flange_from_camera;  ///< there for kEyeInHand, only
  std::optional<MeasuredPoseSettings> base_from_camera;    ///< there for kEyeToHand, only
  std::optional<CovarianceSettings> covariance;
};

/// Keys of [cell]: where things are at the robot.
struct CellSettings {
  std::filesystem::path file;  ///< cell file of the arm that takes the views; empty: none
  std::optional<MeasuredPoseSettings> base_from_part;    ///< the part lies in the cell
  std::optional<MeasuredPoseSettings> flange_from_part;  ///< the robot holds the part
};

/// Keys of [reference]: real pictures to compare with.
struct ReferenceSettings {
  std::vector<std::filesystem::path> pictures;
  std::vector<std::filesystem::path> masks;  ///< none, or one a picture
  std::filesystem::path calibration;         ///< of the camera that took them; empty: the scene's
};

void visit_keys(KeyVisitor& keys, CovarianceSettings& settings);
void visit_keys(KeyVisitor& keys, CalibrationSettings& settings);
void visit_keys(KeyVisitor& keys, CellSettings& settings);
void visit_keys(KeyVisitor& keys, ReferenceSettings& settings);

/// The covariance as one matrix: 15 x 15 of intrinsics, then hand-eye; 9 x 9 without hand-eye;
/// 0 x 0 when none is told.
Eigen::MatrixXd covariance_of(const CovarianceSettings& settings);

/// Sets a pose's standard deviations to the roots of the hand-eye's variances; without any the pose
/// stays as it is.
void take_sigmas(const CovarianceSettings& covariance, MeasuredPoseSettings& pose);

/// Inverse of covariance_of(). @param covariance  symmetric, 9 x 9 or 15 x 15
CovarianceSettings covariance_settings(const Eigen::MatrixXd& covariance);

}  // namespace glint
