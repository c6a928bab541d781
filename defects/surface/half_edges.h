// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner header of glint::defects::surface: which face lies across an edge, and which faces share a
// vertex. Half edge 3 f + k runs from corner k of face f to corner k + 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// An index of the mesh as an index of a vector.
constexpr std::size_t at(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

constexpr std::int32_t next_corner(std::int32_t half_edge) {
  return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
}

constexpr std::int32_t previous_corner(std::int32_t half_edge) {
  return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1;
}

/// The vertex a half edge comes from.
inline std::int32_t origin_of(const TriangleMesh& mesh, std::int32_t half_edge) {
  return mesh.triangles[at(half_edge / 3)][at(half_edge % 3)];
}

/// The corners (= half edges that leave) of every vertex. Linear.
class VertexCorners {
 public:
  explicit VertexCorners(const TriangleMesh& mesh);

  /// In ascending order.
  std::span<const std::int32_t> of(std::int32_t vertex) const {
    const auto begin = static_cast<std::size_t>(begin_[at(vertex)]);
    return std::span(corners_).subspan(begin, at(begin_[at(vertex) + 1]) - begin);
  }

 private:
  std::vector<std::int32_t> begin_;
  std::vector<std::int32_t> corners_;
};

/// For every half edge the one that runs against it in the neighbouring face; -1 where the edge is
/// open, belongs to more than two faces, or its faces are turned against each other. Linear.
std::vector<std::int32_t> opposite_half_edges(const TriangleMesh& mesh,
                                              const VertexCorners& corners);

/// Interior angle [rad] of a triangle at a corner, 0 where it has no area.
double corner_angle_rad(const TriangleMesh& mesh, std::int32_t corner);

}  // namespace glint
