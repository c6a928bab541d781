// SPDX-License-Identifier: GPL-3.0-or-later
//
// Boundaries of regions as points with normals: lines along which a picture has a level.
//
// Pixel (0, 0) begins at the point (0, 0); its centre is (0.5, 0.5). y points down.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/image/image.h"

namespace glint {

struct BoundaryPoint {
  Eigen::Vector2d at_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< unit, to where values are lower
};

/// Consecutive points of one boundary; the region of higher values lies on the same side of all.
struct Boundary {
  std::vector<BoundaryPoint> points;
  bool is_closed = false;  ///< the last point is followed by the first one
};

/// All lines along which a picture of pixel means has a level, about a point a pixel, by linear
/// interpolation between the centres of pixels. Normals are those of the line over some pixels.
/// Lines end at the centres of the outermost pixels.
/// @param min_points  shorter lines are left out
std::vector<Boundary> boundaries_at(const ImageF& picture, float level, std::size_t min_points = 8);

/// Boundaries of a mask, whose steps are smoothed over some two pixels.
std::vector<Boundary> boundaries_of(const Mask& mask, std::size_t min_points = 8);

/// The picture by bilinear interpolation between centres of pixels; beyond the outermost centres
/// the nearest of them.
double sample(const ImageF& picture, const Eigen::Vector2d& at_px);

}  // namespace glint
