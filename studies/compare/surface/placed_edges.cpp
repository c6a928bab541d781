// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/placed_edges.h"

#include <utility>

namespace glint {

PlacedEdges placed_edges(const SimulatedSurface& surface,
                         const PinholeCamera& camera,
                         std::span<const Boundary> boundaries) {
  PlacedEdges placed;
  for (const Boundary& boundary : boundaries) {
    Boundary kept;
    std::vector<Eigen::Vector3d> places;
    for (const BoundaryPoint& point : boundary.points) {
      if (const auto place = surface.at_edge(camera, point.at_px, point.normal)) {
        kept.points.push_back(point);
        places.push_back(*place);
      }
    }
    placed.boundaries.push_back(std::move(kept));
    placed.in_camera_mm.push_back(std::move(places));
  }
  return placed;
}

}  // namespace glint
