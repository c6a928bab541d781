// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/escape_cone.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

namespace glint {
namespace {

using Eigen::Vector3d;

/// The vertices that stand out furthest in 26 directions: most triangles that anything rises above
/// have one of these in front of them.
std::vector<Vector3d> outermost(const TriangleMesh& mesh) {
  std::vector<Vector3d> directions;
  for (int i = 0; i < 27; ++i) {
    if (i != 13) {
      directions.emplace_back(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    }
  }
  std::vector<Vector3d> outermost_mm(directions.size(), mesh.vertices_mm.front());
  for (const Vector3d& vertex : mesh.vertices_mm) {
    for (std::size_t k = 0; k < directions.size(); ++k) {
      if (directions[k].dot(vertex) > directions[k].dot(outermost_mm[k])) {
        outermost_mm[k] = vertex;
      }
    }
  }
  return outermost_mm;
}

/// Tells the triangles that nothing rises above. Looks at all vertices for few planes only; others
/// count as overlooked, which makes the cone smaller and no less right.
class OpenPlanes {
 public:
  explicit OpenPlanes(const TriangleMesh& mesh) : mesh_(mesh), outermost_mm_(outermost(mesh)) {}

  bool is_open(const Vector3d& normal, double offset_mm) {
    const auto is_in_front = [&](const Vector3d& p_mm) {
      return normal.dot(p_mm) > offset_mm + kFlat_mm;
    };
    if (std::ranges::any_of(outermost_mm_, is_in_front)) {
      return false;
    }
    for (const Plane& known : known_) {
      if ((known.normal - normal).cwiseAbs().maxCoeff() < kSameNormal &&
          std::abs(known.offset_mm - offset_mm) < kFlat_mm) {
        return known.is_open;
      }
    }
    if (known_.size() >= kMostPlanes) {
      return false;
    }
    known_.push_back({.normal = normal,
                      .offset_mm = offset_mm,
                      .is_open = std::ranges::none_of(mesh_.vertices_mm, is_in_front)});
    return known_.back().is_open;
  }

 private:
  static constexpr std::size_t kMostPlanes = 16;
  static constexpr double kFlat_mm = 1e-7;      ///< rounding of coordinates
  static constexpr double kSameNormal = 1e-12;  ///< rounding of normals

  struct Plane {
    Vector3d normal;
    double offset_mm = 0.0;
    bool is_open = false;
  };

  const TriangleMesh& mesh_;
  std::vector<Vector3d> outermost_mm_;
  std::vector<Plane> known_;
};

/// Bounds of the normals of triangles that something rises above.
EscapeCone normals_between(const TriangleMesh& mesh) {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;
  OpenPlanes planes(mesh);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Vector3d normal = face_normal(mesh, i);
    if (normal.squaredNorm() > 0.0 && !planes.is_open(normal, normal.dot(mesh.vertex(i, 0)))) {
      low = low.cwiseMin(normal);
      high = high.cwiseMax(normal);
    }
  }
  // The middle of the bounds sees most of them from in front.
  const Vector3d middle = low + high;
  const double least = low.cwiseProduct(middle).cwiseMin(high.cwiseProduct(middle)).sum();
  return {.is_empty = !(least > 0.0),
          .low = {low.x(), low.y(), low.z()},
          .high = {high.x(), high.y(), high.z()}};
}

/// Six times the volume between a triangle and the origin.
double six_volumes(const TriangleMesh& mesh, std::size_t triangle) {
  return mesh.vertex(triangle, 0).dot(mesh.vertex(triangle, 1).cross(mesh.vertex(triangle, 2)));
}

/// Closed, consistently turned, and each piece turned outwards: from outside, only triangles that
/// face a ray can be met.
bool is_solid(const TriangleMesh& mesh) {
  std::vector<std::int32_t> piece(mesh.num_triangles());
  std::iota(piece.begin(), piece.end(), 0);
  const auto piece_of = [&](std::int32_t i) {
    while (piece[static_cast<std::size_t>(i)] != i) {
      const std::int32_t up = piece[static_cast<std::size_t>(i)];
      piece[static_cast<std::size_t>(i)] = piece[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  };
  for (const MeshEdge& edge : mesh_edges(mesh)) {
    if (edge.num_faces != 2 || !edge.is_consistent) {
      return false;
    }
    piece[static_cast<std::size_t>(piece_of(edge.triangle_a))] = piece_of(edge.triangle_b);
  }
  std::vector<double> volumes(mesh.num_triangles());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    volumes[static_cast<std::size_t>(piece_of(static_cast<std::int32_t>(i)))] +=
        six_volumes(mesh, i);
  }
  return std::ranges::all_of(volumes, [](double volume) { return volume >= 0.0; });
}

}  // namespace

EscapeCone find_escape_cone(const TriangleMesh& mesh) {
  // To see whether a larger mesh is closed takes longer than the rays that it saves.
  constexpr std::size_t kMostTriangles = 200'000;
  if (mesh.triangles.empty() || mesh.triangles.size() > kMostTriangles) {
    return {};
  }
  EscapeCone cone = normals_between(mesh);
  cone.is_empty = cone.is_empty || !is_solid(mesh);
  return cone;
}

}  // namespace glint
