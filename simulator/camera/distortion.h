// SPDX-License-Identifier: GPL-3.0-or-later
//
// Brown-Conrady distortion of the normalised image plane x/z, y/z, and where it folds.
#pragma once

#include <array>

#include <Eigen/Core>

namespace glint {

/// Coefficients in OpenCV's order and sign (its vector is k1, k2, p1, p2, k3).
///
/// Source: D. C. Brown, "Close-range camera calibration", Photogrammetric Engineering 37(8), 1971.
struct Distortion {
  std::array<double, 3> radial = {0, 0, 0};   ///< (k1, k2, k3), dimensionless
  std::array<double, 2> tangential = {0, 0};  ///< (p1, p2), dimensionless
};

/// The distorted point of an undistorted one, both x/z and y/z.
/// @param jacobian  not null: receives the derivative by the undistorted point
Eigen::Vector2d distort(const Distortion& distortion,
                        const Eigen::Vector2d& undistorted,
                        Eigen::Matrix2d* jacobian);

/// The smallest undistorted x/z radius at which r (1 + k1 r^2 + k2 r^4 + k3 r^6) stops growing;
/// infinite when it never does. The tangential terms are not looked at.
double radial_fold_radius(const std::array<double, 3>& radial);

/// The smallest undistorted x/z radius at which, in any direction, the determinant of the Jacobian
/// vanishes: there the image turns back upon itself. Infinite when that happens nowhere.
double fold_radius(const Distortion& distortion);

/// False when the determinant of the Jacobian is not positive somewhere on the straight way from
/// the principal point to this undistorted one, that is, when the point lies beyond a fold.
bool is_before_fold(const Distortion& distortion, const Eigen::Vector2d& undistorted);

}  // namespace glint
