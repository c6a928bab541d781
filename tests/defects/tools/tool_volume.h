// SPDX-License-Identifier: GPL-3.0-or-later
//
// What tests measure on tools at the surface z = 0, and a plain box.
#pragma once

#include <cmath>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {

/// What a flat surface z = 0 loses to a closed tool.
struct FlatCut {
  double volume_mm3 = 0.0;
  double opening_mm2 = 0.0;
};

/// By the divergence theorem for the fields (0, 0, z) and (0, 0, 1): the flat lid at z = 0 adds
/// nothing to the first, and minus the lid is all there is of the second.
inline FlatCut flat_cut(const TriangleMesh& mesh) {
  FlatCut cut;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    std::vector<Eigen::Vector3d> below;
    for (std::size_t c = 0; c < 3; ++c) {
      const Eigen::Vector3d& a = mesh.vertex(i, c);
      const Eigen::Vector3d& b = mesh.vertex(i, (c + 1) % 3);
      if (a.z() < 0.0) {
        below.push_back(a);
      }
      if ((a.z() < 0.0) != (b.z() < 0.0)) {
        below.emplace_back(a + a.z() / (a.z() - b.z()) * (b - a));
      }
    }
    for (std::size_t c = 2; c < below.size(); ++c) {
      const Eigen::Vector3d area = 0.5 * (below[c - 1] - below[0]).cross(below[c] - below[0]);
      cut.volume_mm3 += area.z() * (below[0].z() + below[c - 1].z() + below[c].z()) / 3.0;
      cut.opening_mm2 -= area.z();
    }
  }
  return cut;
}

/// A box of 12 triangles, closed, turned outwards.
inline TriangleMesh box_mesh(const Eigen::Vector3d& min_mm, const Eigen::Vector3d& max_mm) {
  TriangleMesh box = cube_mesh(1.0);
  for (Eigen::Vector3d& p : box.vertices_mm) {
    p = (p.array() > 0.0).select(max_mm, min_mm).eval();
  }
  return box;
}

inline double lowest_z_mm(const TriangleMesh& mesh) {
  return bounding_box(mesh).min_mm.z();
}

inline bool same_bytes(const TriangleMesh& a, const TriangleMesh& b) {
  return a.vertices_mm == b.vertices_mm && a.triangles == b.triangles;
}

}  // namespace glint
