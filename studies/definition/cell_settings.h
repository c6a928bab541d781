// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tables that join a scene to a real camera and robot: [calibration], [cell], [reference],
// [validate].
#pragma once

#include <filesystem>
#include <optional>
#include <string>
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

/// Keys of [validate]: which designs are tried out on the real cell, up to which differences
/// pictures agree, and what a refit may set right: beyond that it is a fault. docs/validate.md
struct ValidateSettings {
  std::string designs;          ///< names with commas between them; empty: winner and prototypes
  double edge_px = 0.6;         ///< >= 0; of edges, mean distance
  double grey_share = 0.03;     ///< > 0; of even grey values, of their mean
  double texture = 0.15;        ///< > 0; log10 of the ratio of spectra
  double contrast_share = 0.1;  ///< > 0; of a defect's contrast
  double pose_mm = 0.5;         ///< >= 0; of the part
  double pose_rad = 0.0087266462599716477;  ///< >= 0
  double light_mm = 6.0;                    ///< >= 0; of a light's place
  double power_share = 0.2;                 ///< >= 0; of one segment of a light against the others
  double exposure_share = 0.15;             ///< >= 0
  double roughness_share = 0.25;            ///< >= 0
  double blur_px = 1.0;                     ///< >= 0
};

void visit_keys(KeyVisitor& keys, CovarianceSettings& settings);
void visit_keys(KeyVisitor& keys, CalibrationSettings& settings);
void visit_keys(KeyVisitor& keys, CellSettings& settings);
void visit_keys(KeyVisitor& keys, ReferenceSettings& settings);
void visit_keys(KeyVisitor& keys, ValidateSettings& settings);

/// The covariance as one matrix: 15 x 15 of intrinsics, then hand-eye; 9 x 9 without hand-eye;
/// 0 x 0 when none is told.
Eigen::MatrixXd covariance_of(const CovarianceSettings& settings);

/// Sets a pose's standard deviations to the roots of the hand-eye's variances; without any the pose
/// stays as it is.
void take_sigmas(const CovarianceSettings& covariance, MeasuredPoseSettings& pose);

/// Inverse of covariance_of(). @param covariance  symmetric, 9 x 9 or 15 x 15
CovarianceSettings covariance_settings(const Eigen::MatrixXd& covariance);

}  // namespace glint
