// SPDX-License-Identifier: GPL-3.0-or-later
//
// What changes of pose, lens and camera leave of an edge's offset, for Ceres. Private to the room.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Core>

#include "studies/compare/fit/cause_fit.h"

namespace glint::compare_detail {

constexpr std::size_t index_of(CauseParameter parameter) {
  return static_cast<std::size_t>(parameter);
}

/// A point turned about an axis by the axis' length (Rodrigues), to first order where that is near
/// zero, so that its derivatives exist there.
template <class T>
void turn(const T* axis, const T* point, T* turned) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T square = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
  const bool is_turned = square > T(std::numeric_limits<double>::epsilon());
  const T angle = is_turned ? sqrt(square) : T(1.0);
  const T w[3] = {axis[0] / angle, axis[1] / angle, axis[2] / angle};
  const T across[3] = {w[1] * point[2] - w[2] * point[1],
                       w[2] * point[0] - w[0] * point[2],
                       w[0] * point[1] - w[1] * point[0]};
  const T along = w[0] * point[0] + w[1] * point[1] + w[2] * point[2];
  const T cosine = cos(angle);
  const T sine = sin(angle);
  for (int k = 0; k < 3; ++k) {
    turned[k] = is_turned ? point[k] * cosine + across[k] * sine + w[k] * along * (T(1.0) - cosine)
                          : point[k] + across[k];
  }
}

/// The pixel of a point under changes of all parameters.
template <class T>
void project(const PinholeIntrinsics& camera,
             const Eigen::Vector3d& middle_mm,
             const T* change,
             const Eigen::Vector3d& point_mm,
             T* pixel) {
  const Eigen::Vector3d from = point_mm - middle_mm;
  const T around[3] = {T(from.x()), T(from.y()), T(from.z())};
  T turned[3];
  turn(change, around, turned);
  const T z = turned[2] + middle_mm.z() + change[index_of(CauseParameter::kDistance)];
  const T x = (turned[0] + middle_mm.x() + change[index_of(CauseParameter::kShiftX)]) / z;
  const T y = (turned[1] + middle_mm.y() + change[index_of(CauseParameter::kShiftY)]) / z;
  const T r2 = x * x + y * y;
  const T k1 = camera.radial[0] + change[index_of(CauseParameter::kK1)];
  const T p1 = camera.tangential[0] + change[index_of(CauseParameter::kP1)];
  const double p2 = camera.tangential[1];
  const T radial = 1.0 + r2 * (k1 + r2 * (camera.radial[1] + r2 * camera.radial[2]));
  const T u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const T v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  const T focal = 1.0 + change[index_of(CauseParameter::kFocalLength)] / camera.focal_px.x();
  pixel[0] = camera.focal_px.x() * focal * u + camera.center_px.x() +
             change[index_of(CauseParameter::kCentreX)];
  pixel[1] = camera.focal_px.y() * focal * v + camera.center_px.y() +
             change[index_of(CauseParameter::kCentreY)];
}

/// Offset of an edge that the changes leave.
struct EdgeCost {
  const PinholeIntrinsics& camera;
  const Eigen::Vector3d& middle_mm;
  const SpaceEdge& edge;
  Eigen::Vector2d before_px;
  double root_weight = 1.0;

  template <class T>
  bool operator()(const T* change, T* rest) const {
    T pixel[2];
    project(camera, middle_mm, change, edge.in_camera_mm, pixel);
    rest[0] = root_weight * (edge.offset_px - ((pixel[0] - before_px.x()) * edge.normal.x() +
                                               (pixel[1] - before_px.y()) * edge.normal.y()));
    return true;
  }
};

inline EdgeCost cost_of(const PinholeIntrinsics& camera,
                        const Eigen::Vector3d& middle_mm,
                        const SpaceEdge& edge) {
  return {.camera = camera,
          .middle_mm = middle_mm,
          .edge = edge,
          .before_px = changed_pixel(camera, middle_mm, CauseVector{}, edge.in_camera_mm)};
}

}  // namespace glint::compare_detail
