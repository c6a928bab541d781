// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/error.h"

namespace glint {

/// A rigid motion named target_from_source: it takes a point given in the source frame to the same
/// point given in the target frame. Chains cancel: a_from_c = a_from_b * b_from_c.
struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point_mm) const {
    return rotation * point_mm + translation_mm;
  }
};

inline RigidTransform operator*(const RigidTransform& a_from_b, const RigidTransform& b_from_c) {
  return {.rotation = a_from_b.rotation * b_from_c.rotation,
          .translation_mm = a_from_b.rotation * b_from_c.translation_mm + a_from_b.translation_mm};
}

inline RigidTransform inverse(const RigidTransform& a_from_b) {
  const Eigen::Matrix3d rotation = a_from_b.rotation.transpose();
  return {.rotation = rotation, .translation_mm = -(rotation * a_from_b.translation_mm)};
}

/// Three floats of a ray kernel as a vector in double.
inline Eigen::Vector3d vector_of(float x, float y, float z) {
  return Eigen::Vector3f(x, y, z).cast<double>();
}

/// @param three  numbers, as files have them
inline Eigen::Vector3d vector_of(const std::vector<double>& three) {
  GLINT_CHECK(three.size() == 3, "three numbers");
  return {three[0], three[1], three[2]};
}

/// A ray with unit direction.
struct Ray {
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
};

}  // namespace glint
