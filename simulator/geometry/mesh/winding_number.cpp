// SPDX-License-Identifier: GPL-3.0-or-later
//
// Solid angles by van Oosterom and Strackee's formula, tan(half) = det / (sum of products): atan2
// keeps it exact for large angles and needs no case for points near a triangle's plane. Cost:
// linear in the triangles; for single points, where a tree would not pay.
#include "simulator/geometry/mesh/winding_number.h"

#include <cmath>

#include <Eigen/Geometry>

#include "core/units.h"

namespace glint {

double winding_number(const TriangleMesh& mesh, const Eigen::Vector3d& point_mm) {
  double halves_sr = 0.0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Eigen::Vector3d a = mesh.vertex(i, 0) - point_mm;
    const Eigen::Vector3d b = mesh.vertex(i, 1) - point_mm;
    const Eigen::Vector3d c = mesh.vertex(i, 2) - point_mm;
    const double length_a = a.norm();
    const double length_b = b.norm();
    const double length_c = c.norm();
    halves_sr += std::atan2(a.dot(b.cross(c)),
                            length_a * length_b * length_c + a.dot(b) * length_c +
                                b.dot(c) * length_a + c.dot(a) * length_b);
  }
  return halves_sr / (2.0 * kPi);
}

}  // namespace glint
