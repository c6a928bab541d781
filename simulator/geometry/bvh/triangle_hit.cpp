// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/bvh/triangle_hit.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "core/index.h"

namespace glint {
namespace {

using Eigen::Vector3d;

Vector3d nearest_on_segment(const Vector3d& a, const Vector3d& b, const Vector3d& p) {
  const Vector3d along = b - a;
  const double squared = along.squaredNorm();
  const double share = squared > 0.0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return a + share * along;
}

}  // namespace

Vector3d hit_point(const TriangleMesh& mesh, const Hit& hit) {
  const std::size_t i = index(hit.triangle);
  const Vector3d& p = mesh.vertex(i, 0);
  return p + static_cast<double>(hit.u) * (mesh.vertex(i, 1) - p) +
         static_cast<double>(hit.v) * (mesh.vertex(i, 2) - p);
}

Vector3d shading_normal(const TriangleMesh& mesh, const Hit& hit) {
  const std::size_t i = index(hit.triangle);
  const auto u = static_cast<double>(hit.u);
  const auto v = static_cast<double>(hit.v);
  const Vector3d sum =
      (1.0 - u - v) * mesh.normal(i, 0) + u * mesh.normal(i, 1) + v * mesh.normal(i, 2);
  const double length = sum.norm();
  return length > 0.0 ? Vector3d(sum / length) : face_normal(mesh, i);
}

Vector3d nearest_on_triangle(const TriangleMesh& mesh, std::size_t triangle, const Vector3d& p) {
  const Vector3d& a = mesh.vertex(triangle, 0);
  const Vector3d& b = mesh.vertex(triangle, 1);
  const Vector3d& c = mesh.vertex(triangle, 2);
  const Vector3d normal = (b - a).cross(c - a);
  const bool is_above = normal.dot((b - a).cross(p - a)) >= 0.0 &&
                        normal.dot((c - b).cross(p - b)) >= 0.0 &&
                        normal.dot((a - c).cross(p - c)) >= 0.0;
  const double squared = normal.squaredNorm();
  if (is_above && squared > 0.0) {
    return p - (normal.dot(p - a) / squared) * normal;
  }
  Vector3d best = nearest_on_segment(a, b, p);
  for (const Vector3d& other : {nearest_on_segment(b, c, p), nearest_on_segment(c, a, p)}) {
    best = (other - p).squaredNorm() < (best - p).squaredNorm() ? other : best;
  }
  return best;
}

Vector3d geometric_normal(const TriangleMesh& mesh, const Hit& hit) {
  return face_normal(mesh, index(hit.triangle));
}

}  // namespace glint
