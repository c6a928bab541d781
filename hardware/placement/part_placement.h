// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the part is in the robot's base: from touched points, a board at a known place on it, or
// its points and edges in pictures of a calibrated camera.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hardware/calibration/hand_eye_calibration.h"

namespace glint {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A part's pose and how well it is known.
struct PlacedPart {
  Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
  /// Of the increment in base_from_part * motion_of(increment): rotation in rad, translation in mm,
  /// both in the part's frame.
  Matrix6d covariance = Matrix6d::Zero();
  double rms = 0.0;  ///< of the distances that remain: mm of touched points, px of pictures

  /// Roots of the sums of the three axes' variances.
  double rotation_sigma_rad() const { return std::sqrt(covariance.diagonal().head<3>().sum()); }

  double translation_sigma_mm() const { return std::sqrt(covariance.diagonal().tail<3>().sum()); }
};

/// Least squares over points of the part that the robot has touched, in closed form.
/// @param part_mm, base_mm  the same points in both frames, equally many
/// @param sigma_mm  of a touched point along one axis, > 0; not given: from what remains, which
///                  needs more than 3 points
/// @return empty with fewer than 3 points, with points on one line, or too few to tell sigma_mm
///
/// Source: S. Umeyama, "Least-squares estimation of transformation parameters between two point
/// patterns", IEEE TPAMI 13(4), 1991, without scale.
std::optional<PlacedPart> place_by_points(std::span<const Eigen::Vector3d> part_mm,
                                          std::span<const Eigen::Vector3d> base_mm,
                                          std::optional<double> sigma_mm);

/// From a board whose pose is known, as that of a calibration with the camera on the flange, and
/// its place on the part.
/// @param board_covariance, offset_covariance  of increments of base_from_board, board_from_part
PlacedPart place_by_board(const Eigen::Isometry3d& base_from_board,
                          const Matrix6d& board_covariance,
                          const Eigen::Isometry3d& board_from_part,
                          const Matrix6d& offset_covariance);

/// What a calibration tells of the camera.
struct PlacingCamera {
  Mounting mounting = Mounting::kEyeInHand;
  LensVector lens = LensVector::Zero();
  Eigen::Isometry3d hand_eye = Eigen::Isometry3d::Identity();
  /// Of the nine intrinsics and the hand-eye's increment.
  Eigen::Matrix<double, 15, 15> covariance = Eigen::Matrix<double, 15, 15>::Zero();
  double robot_rad = 0.0;  ///< error of a robot pose, as NoiseSizes; 0: none
  double robot_mm = 0.0;
};

/// Points or edges of the part that one picture shows.
struct PartPicture {
  std::vector<Eigen::Vector3d> part_mm;     ///< on the part
  std::vector<Eigen::Vector2d> picture_px;  ///< where they were found; same length
  /// Of edges: unit normals in the picture, only the distance along them counts. Empty: points.
  std::vector<Eigen::Vector2d> normals;
  Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();
};

/// Joint refinement of the part's pose, the robot's error in each picture, and intrinsics and
/// hand-eye within what the calibration knows of them. A point farther off than 3 sigma counts by
/// (3 sigma / distance)^2. With the camera in the cell the robot's poses do not matter.
/// @param start  near enough that the distances are nearly linear: some degrees
/// @param sigma_px  of a point along one axis, or of an edge across itself, > 0
/// @return empty when points and edges leave a direction open, when a point is behind the camera,
///         or when no solution is found
std::optional<PlacedPart> place_by_pictures(const PlacingCamera& camera,
                                            std::span<const PartPicture> pictures,
                                            const Eigen::Isometry3d& start,
                                            double sigma_px);

}  // namespace glint
