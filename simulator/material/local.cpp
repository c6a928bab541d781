// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/local.h"

#include <Eigen/Geometry>

namespace glint {
namespace {

/// Below this share of its length in the surface, a tangent's direction is rounding.
constexpr double kMinShare = 1e-9;

/// Source: T. Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1), 2017.
Eigen::Vector3d any_tangent(const Eigen::Vector3d& normal) {
  const double sign = std::copysign(1.0, normal.z());
  const double a = -1.0 / (sign + normal.z());
  return {1.0 + sign * normal.x() * normal.x() * a,
          sign * normal.x() * normal.y() * a,
          -sign * normal.x()};
}

}  // namespace

ShadingFrame frame_at(const Eigen::Vector3d& normal, const Eigen::Vector3d& tangent) {
  Eigen::Vector3d in_surface = tangent - normal * normal.dot(tangent);
  const double length = in_surface.norm();
  if (length > kMinShare * tangent.norm()) {
    in_surface /= length;
  } else {
    in_surface = any_tangent(normal);
  }
  return {.tangent = in_surface, .bitangent = normal.cross(in_surface), .normal = normal};
}

}  // namespace glint
