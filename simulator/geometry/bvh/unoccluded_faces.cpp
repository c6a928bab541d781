// SPDX-License-Identifier: GPL-3.0-or-later
//
// Area vectors of the triangles are gathered by their direction; for the 24 directions with most
// area at most, the highest vertex along each is found, and triangles that reach it within the
// tolerance are a face that nothing rises above. Built once a mesh, a pass over all triangles and
// vertices for each direction; asked by one look into a table a ray. docs/theory/tunnel.md, "What
// is kept".
#include "simulator/geometry/bvh/unoccluded_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMaxDirections = 24;
/// Directions with less than this share of the whole area are not looked at.
constexpr double kMinShare = 0.005;
/// Normals are first collected in cells of this width.
constexpr double kCell = 1.0 / 512.0;
/// Cosines from which on normals belong to one direction, and triangles to its face.
constexpr double kSameDirection = 1.0 - 1e-6;
constexpr double kSameFace = 1.0 - 1e-4;

struct Direction {
  std::int64_t cell = 0;
  Vector3d area = Vector3d::Zero();  ///< sum of area vectors
};

std::int64_t cell_of(const Vector3d& normal) {
  constexpr std::int64_t kCells = 2048;
  const auto at = [](double x) {
    return static_cast<std::int64_t>(std::floor(x / kCell)) + kCells / 2;
  };
  return (at(normal.x()) * kCells + at(normal.y())) * kCells + at(normal.z());
}

/// The directions with most area, the largest first.
std::vector<Direction> directions_of(const std::vector<Vector3d>& areas) {
  std::unordered_map<std::int64_t, std::size_t> places;
  std::vector<Direction> all;
  double whole = 0.0;
  for (const Vector3d& area : areas) {
    const double size = area.norm();
    if (!(size > 0.0)) {
      continue;
    }
    whole += size;
    const std::int64_t cell = cell_of(area / size);
    const auto [place, is_new] = places.try_emplace(cell, all.size());
    if (is_new) {
      all.push_back({.cell = cell});
    }
    all[place->second].area += area;
  }
  std::erase_if(all, [&](const Direction& d) { return d.area.norm() < kMinShare * whole; });
  std::ranges::sort(all, [](const Direction& a, const Direction& b) {
    const double size_a = a.area.norm();
    const double size_b = b.area.norm();
    return size_a != size_b ? size_a > size_b : a.cell < b.cell;
  });
  all.resize(std::min(all.size(), kMaxDirections));
  return all;
}

/// Mean of the normals near a direction, whatever cells they fell into.
Vector3d refined(const Vector3d& direction, const std::vector<Vector3d>& areas) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& area : areas) {
    const double along = area.dot(direction);
    if (along > 0.0 && along * along > kSameDirection * kSameDirection * area.squaredNorm()) {
      sum += area;
    }
  }
  return sum.squaredNorm() > 0.0 ? sum.normalized() : direction;
}

}  // namespace

UnoccludedFaces find_unoccluded_faces(const TriangleMesh& mesh, double tolerance_mm) {
  std::vector<Vector3d> areas;
  areas.reserve(mesh.num_triangles());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    areas.push_back(area_vector(mesh, i));
  }
  UnoccludedFaces sides;
  sides.of_triangle.assign(mesh.num_triangles(), -1);
  for (const Direction& direction : directions_of(areas)) {
    const Vector3d normal = refined(direction.area.normalized(), areas);
    double highest_mm = -std::numeric_limits<double>::infinity();
    for (const Vector3d& vertex : mesh.vertices_mm) {
      highest_mm = std::max(highest_mm, normal.dot(vertex));
    }
    const auto side = static_cast<std::int32_t>(sides.normals.size());
    bool is_used = false;
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
      const auto is_high = [&](std::size_t corner) {
        return normal.dot(mesh.vertex(i, corner)) >= highest_mm - tolerance_mm;
      };
      if (sides.of_triangle[i] < 0 && areas[i].dot(normal) > kSameFace * areas[i].norm() &&
          is_high(0) && is_high(1) && is_high(2)) {
        sides.of_triangle[i] = side;
        is_used = true;
      }
    }
    if (is_used) {
      sides.normals.push_back(normal);
    }
  }
  return sides;
}

}  // namespace glint
