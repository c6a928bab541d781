// SPDX-License-Identifier: GPL-3.0-or-later
//
// A camera's rays from what its pixels see: also of pixels that see nothing.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "simulator/render/ray_cache/ray_cache.h"

namespace glint {

/// Rays of a camera without distortion. On a plane across them they are a projective map of the
/// picture, which some pixels that see the part determine.
class PixelRays {
 public:
  /// Nothing when fewer than kFewest of the pixels looked at see the part, or when one of them is
  /// off its ray by more than a pixel: the lens distorts, or this is not the camera.
  static std::optional<PixelRays> through(const VisibilityBuffer& seen,
                                          const Eigen::Vector3d& camera_in_world_mm);

  /// A point on the ray of a pixel, about as far from the camera as the part.
  Eigen::Vector3d point(int x, int y) const;

 private:
  static constexpr int kMinSamples = 12;

  Eigen::Vector3d camera_mm_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  ///< columns: across, down, along the rays
  double distance_mm_ = 1.0;
  Eigen::Vector2d per_px_ = Eigen::Vector2d::Ones();  ///< from pixels to [-1, 1]
  Eigen::Matrix3d map_ = Eigen::Matrix3d::Identity();
};

}  // namespace glint
