// SPDX-License-Identifier: GPL-3.0-or-later
//
// Directions drawn from a point towards a luminous surface. docs/theory/lights.md
#pragma once

#include <optional>

#include <Eigen/Core>

#include "simulator/light/area/emitter_shape.h"

namespace glint {

/// A direction towards a surface.
struct ShapeSample {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  double distance_mm = 0.0;
  double cosine = 0.0;   ///< > 0
  double density = 0.0;  ///< per steradian, > 0
};

/// A direction from the point to the surface's front: uniform over the solid angle for near
/// rectangles and triangles, else uniform over the area. Empty when the drawn point shows its back
/// or its edge. @param u, v  in [0, 1)
std::optional<ShapeSample> sample_shape(const EmitterShape& shape,
                                        const Eigen::Vector3d& point_mm,
                                        double u,
                                        double v);

/// The density with which sample_shape() draws the direction that meets the surface like that.
double shape_density(const EmitterShape& shape,
                     const Eigen::Vector3d& point_mm,
                     const ShapeCrossing& crossing);

}  // namespace glint
