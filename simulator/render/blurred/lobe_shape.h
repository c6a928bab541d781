// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "simulator/material/local.h"

namespace glint {

/// A point of rough metal and where it is seen from; unit vectors.
struct BlurredPoint {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d to_viewer = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d mirrored = Eigen::Vector3d::UnitZ();  ///< where a mirror would reflect to
};

/// The lobe of a point in the coordinates of a tunnel along x: a direction is
/// (t, sin phi, cos phi) / sqrt(1 + t^2), phi the angle from the vertical in the cross-section's
/// plane and t the tangent of the elevation out of it. Near its middle the slope of the facets that
/// reflect to (phi, t) is (in widths alpha)
///
///   slope^2 = across (phi - phi0)^2 + along (t - t0 - tilt (phi - phi0))^2.
struct LobeShape {
  ShadingFrame frame;  ///< z: normal
  double phi0_rad = 0.0;
  double t0 = 0.0;
  double across = 1.0;
  double along = 1.0;
  double tilt = 0.0;

  /// How wide the lobe is on a wall, along a coordinate that grows by `per_phi` and `per_t`: where
  /// its profile (1 + x^2 / width^2)^(-3/2) / (2 width) has fallen to 0.35 of its peak.
  double width_along(double per_phi, double per_t) const;
};

/// @param alpha  width of the GGX distribution of slopes, the same along and across
LobeShape lobe_shape(const BlurredPoint& point, double alpha);

}  // namespace glint
