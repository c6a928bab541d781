// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/places/sample_distance.h"

#include <algorithm>

#include "simulator/geometry/mesh/mesh_edges.h"

namespace glint {
namespace {

using Eigen::Vector3d;

bool is_sharp(const TriangleMesh& mesh, const MeshEdge& edge, double crease_rad) {
  return !edge.is_consistent ||
         angle_between_faces(mesh,
                             static_cast<std::size_t>(edge.triangle_a),
                             static_cast<std::size_t>(edge.triangle_b)) > crease_rad;
}

/// Where along a segment of that direction the point nearest to an offset from its start lies.
double share_along(const Vector3d& direction, const Vector3d& offset) {
  const double squared = direction.squaredNorm();
  return squared > 0.0 ? std::clamp(direction.dot(offset) / squared, 0.0, 1.0) : 0.0;
}

}  // namespace

/// Source: C. Ericson, "Real-time collision detection", 2004, section 5.1.9.
double segment_distance(const Vector3d& a_from,
                        const Vector3d& a_to,
                        const Vector3d& b_from,
                        const Vector3d& b_to) {
  const Vector3d a = a_to - a_from;
  const Vector3d b = b_to - b_from;
  const Vector3d between = a_from - b_from;
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  const double ab = a.dot(b);
  const double determinant = aa * bb - ab * ab;
  const double on_lines = determinant > 1e-12 * aa * bb
                              ? (ab * b.dot(between) - bb * a.dot(between)) / determinant
                              : 0.0;
  double s = std::clamp(on_lines, 0.0, 1.0);
  const double t = share_along(b, between + s * a);
  s = share_along(a, t * b - between);
  return (between + s * a - t * b).norm();
}

double rim_distance(const Defect& a, const Defect& b) {
  const Vector3d half_a = a.half_line_mm() * a.place.u_axis;
  const Vector3d half_b = b.half_line_mm() * b.place.u_axis;
  return segment_distance(a.place.centre_mm - half_a,
                          a.place.centre_mm + half_a,
                          b.place.centre_mm - half_b,
                          b.place.centre_mm + half_b) -
         a.radius_mm() - b.radius_mm();
}

SharpEdges::SharpEdges(const TriangleMesh& mesh, double crease_rad) {
  for (const MeshEdge& edge : mesh_edges(mesh)) {
    if (is_sharp(mesh, edge, crease_rad)) {
      Vector3d from = mesh.vertices_mm[static_cast<std::size_t>(edge.from)];
      Vector3d to = mesh.vertices_mm[static_cast<std::size_t>(edge.to)];
      if (from.x() > to.x()) {
        std::swap(from, to);
      }
      longest_mm_ = std::max(longest_mm_, to.x() - from.x());
      edges_.push_back({.from_mm = from, .to_mm = to});
    }
  }
  std::ranges::stable_sort(edges_, {}, [](const Edge& edge) { return edge.from_mm.x(); });
}

bool SharpEdges::is_near(const Vector3d& p_mm, double distance_mm) const {
  const auto x_of = [](const Edge& edge) { return edge.from_mm.x(); };
  const auto first =
      std::ranges::lower_bound(edges_, p_mm.x() - distance_mm - longest_mm_, {}, x_of);
  const auto last = std::ranges::upper_bound(edges_, p_mm.x() + distance_mm, {}, x_of);
  return std::any_of(first, last, [&](const Edge& edge) {
    const Vector3d along = edge.to_mm - edge.from_mm;
    const Vector3d offset = p_mm - edge.from_mm;
    return (offset - share_along(along, offset) * along).norm() < distance_mm;
  });
}

}  // namespace glint
