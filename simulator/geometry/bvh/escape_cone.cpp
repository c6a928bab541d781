// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which rays leave a part for good, so that they need not be traced. A triangle that no vertex
// rises above cannot be met from the part; bounds of the normals of all others tell which
// directions can meet none. Whether one rises above is asked of the 26 vertices that stand out
// furthest, then of boxes of 64 vertices, until 2^20 of them have been looked at: what is
// overlooked costs rays and is no less right. Built once a mesh; asked by three multiplications a
// ray. docs/theory/tunnel.md, "What is kept".
#include "simulator/geometry/bvh/escape_cone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "simulator/geometry/mesh/mesh_edges.h"

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

/// The vertices in groups of neighbours with boxes around them, to see quickly whether any lies in
/// front of a plane.
class VertexGroups {
 public:
  explicit VertexGroups(const std::vector<Vector3d>& vertices_mm) : vertices_mm_(vertices_mm) {
    for (std::size_t first = 0; first < vertices_mm.size(); first += kGroup) {
      Vector3d low = vertices_mm[first];
      Vector3d high = low;
      for (std::size_t i = first; i < std::min(first + kGroup, vertices_mm.size()); ++i) {
        low = low.cwiseMin(vertices_mm[i]);
        high = high.cwiseMax(vertices_mm[i]);
      }
      boxes_.push_back({.centre_mm = 0.5 * (low + high), .half_mm = 0.5 * (high - low)});
    }
  }

  /// @param num_tests  counts boxes and vertices that were looked at
  bool has_one_in_front(const Vector3d& normal, double offset_mm, std::size_t& num_tests) const {
    const Vector3d size = normal.cwiseAbs();
    num_tests += boxes_.size();
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      if (normal.dot(boxes_[k].centre_mm) + size.dot(boxes_[k].half_mm) <= offset_mm) {
        continue;
      }
      const std::size_t end = std::min((k + 1) * kGroup, vertices_mm_.size());
      num_tests += end - k * kGroup;
      for (std::size_t i = k * kGroup; i < end; ++i) {
        if (normal.dot(vertices_mm_[i]) > offset_mm) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::size_t kGroup = 64;

  struct Box {
    Vector3d centre_mm;
    Vector3d half_mm;
  };

  const std::vector<Vector3d>& vertices_mm_;
  std::vector<Box> boxes_;
};

/// Tells the triangles that nothing rises above, as long as that takes little time; later ones
/// count as overlooked, which costs rays and is no less right.
class OpenPlanes {
 public:
  explicit OpenPlanes(const TriangleMesh& mesh)
      : groups_(mesh.vertices_mm), outermost_mm_(outermost(mesh)) {}

  bool is_open(const Vector3d& normal, double offset_mm) {
    const double reach_mm = offset_mm + kFlat_mm;
    const auto is_in_front = [&](const Vector3d& p_mm) { return normal.dot(p_mm) > reach_mm; };
    if (std::ranges::any_of(outermost_mm_, is_in_front)) {
      return false;
    }
    for (const Plane& known : known_) {
      if ((known.normal - normal).cwiseAbs().maxCoeff() < kSameNormal &&
          std::abs(known.offset_mm - offset_mm) < kFlat_mm) {
        return known.is_open;
      }
    }
    if (num_tests_ >= kMaxTests) {
      return false;
    }
    const bool is_open = !groups_.has_one_in_front(normal, reach_mm, num_tests_);
    known_[oldest_] = {.normal = normal, .offset_mm = offset_mm, .is_open = is_open};
    oldest_ = (oldest_ + 1) % known_.size();
    return is_open;
  }

 private:
  static constexpr std::size_t kKnownPlanes = 16;
  static constexpr std::size_t kMaxTests = std::size_t{1} << 20U;  ///< a few ms
  static constexpr double kFlat_mm = 1e-7;                         ///< rounding of coordinates
  static constexpr double kSameNormal = 1e-12;                     ///< rounding of normals

  struct Plane {
    Vector3d normal = Vector3d::Zero();
    double offset_mm = 0.0;
    bool is_open = false;
  };

  VertexGroups groups_;
  std::vector<Vector3d> outermost_mm_;
  std::array<Plane, kKnownPlanes> known_;  ///< the latest: flat faces have many triangles
  std::size_t oldest_ = 0;
  std::size_t num_tests_ = 0;
};

/// The triangles that nothing rises above, and bounds of the normals of the others.
EscapeCone normals_between(const TriangleMesh& mesh) {
  std::vector<std::uint8_t> is_open(mesh.num_triangles(), 0);
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;
  OpenPlanes planes(mesh);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Vector3d normal = face_normal(mesh, i);
    if (!(normal.squaredNorm() > 0.0)) {
      continue;
    }
    if (planes.is_open(normal, normal.dot(mesh.vertex(i, 0)))) {
      is_open[i] = 1;
    } else {
      low = low.cwiseMin(normal);
      high = high.cwiseMax(normal);
    }
  }
  if (std::ranges::find(is_open, 1) == is_open.end()) {
    is_open.clear();
  }
  // The middle of the bounds sees most of them from in front.
  const Vector3d middle = low + high;
  const double minimum = low.cwiseProduct(middle).cwiseMin(high.cwiseProduct(middle)).sum();
  return {.is_empty = !(minimum > 0.0),
          .low = {low.x(), low.y(), low.z()},
          .high = {high.x(), high.y(), high.z()},
          .is_open = std::move(is_open)};
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
  constexpr std::size_t kMaxTriangles = 200'000;
  if (mesh.triangles.empty()) {
    return {};
  }
  EscapeCone cone = normals_between(mesh);
  cone.is_empty = cone.is_empty || mesh.triangles.size() > kMaxTriangles || !is_solid(mesh);
  return cone;
}

}  // namespace glint
