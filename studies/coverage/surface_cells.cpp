// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/coverage/surface_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/rng.h"
#include "defects/surface/edge_bisection.h"
#include "simulator/geometry/mesh/mesh_edges.h"
#include "simulator/geometry/surface/surface_sampling.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// The bits of a number below 2^10 with two free places after each.
std::uint32_t spread_bits(std::uint32_t value) {
  value = (value | value << 16) & 0x030000FFU;
  value = (value | value << 8) & 0x0300F00FU;
  value = (value | value << 4) & 0x030C30C3U;
  return (value | value << 2) & 0x09249249U;
}

/// Numbers of triangles along a curve that fills the part's box (Morton order).
std::vector<std::size_t> order_in_space(const TriangleMesh& mesh) {
  const BoundingBox box = bounding_box(mesh);
  const double side_mm = std::max(box.size_mm().maxCoeff(), 1e-9);
  std::vector<std::uint32_t> keys(mesh.num_triangles());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Vector3d middle_mm = (mesh.vertex(i, 0) + mesh.vertex(i, 1) + mesh.vertex(i, 2)) / 3.0;
    const Vector3d at = 1023.0 * (middle_mm - box.min_mm) / side_mm;
    for (int axis = 0; axis < 3; ++axis) {
      const auto step = static_cast<std::uint32_t>(std::clamp(at[axis], 0.0, 1023.0));
      keys[i] |= spread_bits(step) << static_cast<unsigned>(axis);
    }
  }
  std::vector<std::size_t> order(keys.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return keys[i]; });
  return order;
}

/// Triangles of the part's own mesh, cut; sorted in space.
void cut(const Part& part, int count, SurfaceCells& cells) {
  TriangleMesh mesh = {.vertices_mm = part.mesh.vertices_mm, .triangles = part.mesh.triangles};
  std::vector<std::int32_t> labels(mesh.num_triangles());
  std::vector<std::int32_t> origin(mesh.num_triangles());
  std::iota(origin.begin(), origin.end(), 0);
  // Cut in halves until no edge is longer than L, a triangle has about L^2 / 4.
  const double allowed_mm = 2.0 * std::sqrt(surface_area_mm2(mesh) / count);
  EdgeBisection(mesh, labels, origin, part.patches).refine(origin, [&](std::int32_t) {
    return allowed_mm;
  });
  cells.mesh.vertices_mm = std::move(mesh.vertices_mm);
  for (const std::size_t i :
       order_in_space({.vertices_mm = cells.mesh.vertices_mm, .triangles = mesh.triangles})) {
    cells.mesh.triangles.push_back(mesh.triangles[i]);
    cells.triangle.push_back(origin[i]);
  }
}

/// Uniform over a triangle.
Vector3d point_in(const TriangleMesh& mesh, std::size_t triangle, Rng& rng) {
  const double root = std::sqrt(rng.uniform());
  const double share = rng.uniform();
  return (1.0 - root) * mesh.vertex(triangle, 0) + root * (1.0 - share) * mesh.vertex(triangle, 1) +
         root * share * mesh.vertex(triangle, 2);
}

}  // namespace

SurfaceCells surface_cells(const Part& part, int count, int seed) {
  SurfaceCells cells;
  cut(part, count, cells);
  const std::size_t num_cells = cells.mesh.num_triangles();
  for (std::size_t i = 0; i < num_cells; ++i) {
    Rng rng(static_cast<std::uint64_t>(seed), Stream::kViewpoints, i + 1);
    cells.points_mm.push_back(point_in(cells.mesh, i, rng));
    cells.normals.push_back(smooth_point(part, cells.triangle[i], cells.points_mm[i]).normal);
    cells.areas_mm2.push_back(area_vector(cells.mesh, i).norm());
  }
  for (const MeshEdge& edge : mesh_edges(cells.mesh)) {
    if (edge.triangle_b >= 0) {
      cells.links.push_back({edge.triangle_a, edge.triangle_b});
    }
  }
  return cells;
}

}  // namespace glint
