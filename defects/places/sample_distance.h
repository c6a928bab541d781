// SPDX-License-Identifier: GPL-3.0-or-later
//
// Distances that keep random defects apart: between their rims, and to the part's sharp edges.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "defects/definition/defect.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// The straight distance between two segments [mm]; a segment may be a point.
double segment_distance(const Eigen::Vector3d& a_from,
                        const Eigen::Vector3d& a_to,
                        const Eigen::Vector3d& b_from,
                        const Eigen::Vector3d& b_to);

/// The straight distance between the rims of two defects [mm], lines taken as straight; negative
/// where they overlap.
double rim_distance(const Defect& a, const Defect& b);

/// The edges of a mesh that are sharper than an angle, and those without two faces.
class SharpEdges {
 public:
  SharpEdges() = default;
  /// Cost: one pass over the edges.
  SharpEdges(const TriangleMesh& mesh, double crease_rad);

  std::size_t size() const { return edges_.size(); }

  /// True when an edge lies nearer than distance_mm.
  bool is_near(const Eigen::Vector3d& p_mm, double distance_mm) const;

 private:
  struct Edge {
    Eigen::Vector3d from_mm;  ///< the end with the smaller x
    Eigen::Vector3d to_mm;
  };

  std::vector<Edge> edges_;  ///< ordered by from_mm.x
  double longest_mm_ = 0.0;  ///< along x
};

}  // namespace glint
