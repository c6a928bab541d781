// SPDX-License-Identifier: GPL-3.0-or-later
//
// Curves on a part's surface: what scratches are swept along.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"
#include "simulator/geometry/surface/surface_detail.h"

namespace glint {

/// A point of a curve on a surface with its frame: tangent and normal are unit and orthogonal.
struct SurfacePathPoint {
  double arc_mm = 0.0;  ///< along the curve from its place, negative against u
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< outwards, of the smooth surface
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();  ///< towards growing arc_mm
};

/// The geodesic (straightest curve) through a place along its u axis, both ways, from
/// -half_length_mm to +half_length_mm in equal steps of at most step_mm: an odd number of points
/// with the place in the middle. Scene frame.
///
/// On exact patches the curve is exact to about 1e-8 of its length; on a mesh it follows the
/// triangles with their shading normals. Where the surface ends, or bends by more than 30 degrees
/// within a step, the curve goes straight on along its tangent with the last normal.
/// Method: docs/theory/imprint.md, "Places".
/// @param half_length_mm  >= 0
/// @param step_mm         > 0, at least a millionth of half_length_mm
std::vector<SurfacePathPoint> surface_path(const Part& part,
                                           const Bvh& bvh,
                                           const SurfacePlace& place,
                                           double half_length_mm,
                                           double step_mm);

}  // namespace glint
