// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well a calibrated camera knows where a pixel looks, at any place in the picture.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "hardware/calibration/bundle_diagnostics.h"
#include "hardware/calibration/lens_vector.h"

namespace glint {

/// Standard deviation of the distance, in px, between where a ray is computed to fall and where it
/// falls, from the intrinsics' covariance alone. A turn of the whole camera, which a pose would
/// take up, is taken out: least squares over a grid of 7 x 7 pixels.
/// @param covariance  of a LensVector
/// @return of each pixel; infinite where no ray reaches it
std::vector<double> ray_errors_px(const LensVector& lens,
                                  const Eigen::Matrix<double, 9, 9>& covariance,
                                  const Eigen::Vector2i& size_px,
                                  std::span<const Eigen::Vector2d> pixels_px);

}  // namespace glint
