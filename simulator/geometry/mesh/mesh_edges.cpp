// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh/mesh_edges.h"

#include <algorithm>
#include <tuple>

namespace glint {
namespace {

/// One side of an edge: the triangle it belongs to and whether it runs from `from` to `to` there.
struct HalfEdge {
  std::int32_t from = 0;
  std::int32_t to = 0;
  std::int32_t triangle = 0;
  bool is_forward = false;
};

std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  std::vector<HalfEdge> halves;
  halves.reserve(3 * mesh.num_triangles());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Triangle& t = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = t[k];
      const std::int32_t b = t[(k + 1) % 3];
      halves.push_back({.from = std::min(a, b),
                        .to = std::max(a, b),
                        .triangle = static_cast<std::int32_t>(i),
                        .is_forward = a < b});
    }
  }
  std::ranges::sort(halves, [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.from, a.to, a.triangle, a.is_forward) <
           std::tie(b.from, b.to, b.triangle, b.is_forward);
  });
  return halves;
}

}  // namespace

std::vector<MeshEdge> mesh_edges(const TriangleMesh& mesh) {
  const std::vector<HalfEdge> halves = sorted_half_edges(mesh);
  std::vector<MeshEdge> edges;
  edges.reserve(halves.size() / 2);
  for (std::size_t begin = 0; begin < halves.size();) {
    std::size_t end = begin + 1;
    while (end < halves.size() && halves[end].from == halves[begin].from &&
           halves[end].to == halves[begin].to) {
      ++end;
    }
    MeshEdge edge = {.from = halves[begin].from,
                     .to = halves[begin].to,
                     .num_faces = static_cast<std::int32_t>(end - begin),
                     .triangle_a = halves[begin].triangle};
    if (edge.num_faces >= 2) {
      edge.triangle_b = halves[begin + 1].triangle;
      edge.is_consistent =
          edge.num_faces == 2 && halves[begin].is_forward != halves[begin + 1].is_forward;
    }
    edges.push_back(edge);
    begin = end;
  }
  return edges;
}

}  // namespace glint
