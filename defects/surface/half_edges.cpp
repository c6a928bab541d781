// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/surface/half_edges.h"

#include <cmath>

#include <Eigen/Geometry>

namespace glint {

VertexCorners::VertexCorners(const TriangleMesh& mesh)
    : begin_(mesh.vertices_mm.size() + 1, 0), corners_(3 * mesh.num_triangles()) {
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::int32_t vertex : triangle) {
      ++begin_[at(vertex) + 1];
    }
  }
  for (std::size_t i = 1; i < begin_.size(); ++i) {
    begin_[i] += begin_[i - 1];
  }
  std::vector<std::int32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const std::int32_t vertex = mesh.triangles[i / 3][i % 3];
    corners_[at(next[at(vertex)]++)] = static_cast<std::int32_t>(i);
  }
}

namespace {

/// The only half edge from a to b; -1 when there is none, -2 when there are several.
std::int32_t find_half_edge(const TriangleMesh& mesh,
                            const VertexCorners& corners,
                            std::int32_t a,
                            std::int32_t b) {
  std::int32_t found = -1;
  for (const std::int32_t half : corners.of(a)) {
    if (origin_of(mesh, next_corner(half)) == b) {
      found = found == -1 ? half : -2;
    }
  }
  return found;
}

}  // namespace

std::vector<std::int32_t> opposite_half_edges(const TriangleMesh& mesh,
                                              const VertexCorners& corners) {
  std::vector<std::int32_t> opposite(3 * mesh.num_triangles(), -1);
  for (std::size_t i = 0; i < opposite.size(); ++i) {
    const auto half = static_cast<std::int32_t>(i);
    const std::int32_t a = origin_of(mesh, half);
    const std::int32_t b = origin_of(mesh, next_corner(half));
    if (a >= b || find_half_edge(mesh, corners, a, b) != half) {
      continue;
    }
    const std::int32_t against = find_half_edge(mesh, corners, b, a);
    if (against >= 0) {
      opposite[i] = against;
      opposite[at(against)] = half;
    }
  }
  return opposite;
}

double corner_angle_rad(const TriangleMesh& mesh, std::int32_t corner) {
  const Eigen::Vector3d& p = mesh.vertices_mm[at(origin_of(mesh, corner))];
  const Eigen::Vector3d a = mesh.vertices_mm[at(origin_of(mesh, next_corner(corner)))] - p;
  const Eigen::Vector3d b = mesh.vertices_mm[at(origin_of(mesh, previous_corner(corner)))] - p;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace glint
