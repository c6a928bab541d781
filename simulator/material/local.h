// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frame in which materials speak. At a surface point: z = the outward normal, x = the tangent
// (along the grooves of a machined face, see lay.h), y = z cross x. Directions are unit vectors
// that point away from the surface, also the one the light comes from. They are `double` here; the
// templates of ggx.h serve `float` ray kernels as well.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "core/units.h"

namespace glint {

/// A direction in the frame of a surface point; a type of its own, so that it is not taken for one
/// in the part's frame.
template <class Real>
struct Local {
  Real x = 0;
  Real y = 0;
  Real z = 1;
};

using LocalDirection = Local<double>;

/// A value for each of three wavelengths; a grey camera has three times the same.
using Colour = Eigen::Array3d;

template <class Real>
Real dot(const Local<Real>& a, const Local<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The direction halfway between two; the normal when they are opposite.
template <class Real>
Local<Real> half_vector(const Local<Real>& a, const Local<Real>& b) {
  const Local<Real> sum = {a.x + b.x, a.y + b.y, a.z + b.z};
  const Real length = std::sqrt(dot(sum, sum));
  return length > Real(0) ? Local<Real>{sum.x / length, sum.y / length, sum.z / length}
                          : Local<Real>{};
}

/// A mirror's answer: the direction on the other side of a normal.
template <class Real>
Local<Real> reflect(const Local<Real>& direction, const Local<Real>& normal) {
  const Real twice = Real(2) * dot(direction, normal);
  return {twice * normal.x - direction.x,
          twice * normal.y - direction.y,
          twice * normal.z - direction.z};
}

/// A direction with density z / pi, from two numbers in [0, 1): the azimuth's and the radius'.
inline LocalDirection sample_cosine(double u, double v) {
  const double radius = std::sqrt(v);
  const double phi_rad = 2.0 * kPi * u;
  return {radius * std::cos(phi_rad), radius * std::sin(phi_rad), std::sqrt(1.0 - v)};
}

/// The frame of a surface point in the part's coordinates; orthonormal, right-handed.
struct ShadingFrame {
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();
  Eigen::Vector3d bitangent = Eigen::Vector3d::UnitY();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();

  LocalDirection to_local(const Eigen::Vector3d& direction) const {
    return {tangent.dot(direction), bitangent.dot(direction), normal.dot(direction)};
  }
};

/// The frame whose tangent is the given direction, laid into the surface. A direction that is zero
/// or stands along the normal is replaced by any one in the surface.
/// @param normal  of length 1
ShadingFrame frame_at(const Eigen::Vector3d& normal, const Eigen::Vector3d& tangent);

}  // namespace glint
