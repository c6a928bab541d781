// SPDX-License-Identifier: GPL-3.0-or-later
//
// Edges of a simulated picture with their places in space.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "metrics/overlap/boundary.h"
#include "studies/compare/surface/simulated_surface.h"

namespace glint {

/// Boundary by boundary.
struct PlacedEdges {
  std::vector<Boundary> boundaries;                        ///< points that have a place
  std::vector<std::vector<Eigen::Vector3d>> in_camera_mm;  ///< of each boundary each point
};

/// Points beside the part are left out. @param camera  that the picture was taken with
PlacedEdges placed_edges(const SimulatedSurface& surface,
                         const PinholeCamera& camera,
                         std::span<const Boundary> boundaries);

}  // namespace glint
