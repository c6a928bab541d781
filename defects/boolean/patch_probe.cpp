// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/boolean/patch_probe.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace glint {

using Eigen::Vector3d;

bool Probe::may_intersect(const FloatBox& box) const {
  double enter = 0.0;
  double leave = 1e300;
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    const double a = (static_cast<double>(box.min_mm[axis]) - origin[i]) / direction[i];
    const double b = (static_cast<double>(box.max_mm[axis]) - origin[i]) / direction[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

bool Probe::hits(const Corners& corners) const {
  const Vector3d a = corners[0] - origin;
  const Vector3d b = corners[1] - origin;
  const Vector3d c = corners[2] - origin;
  const double u = direction.dot(a.cross(b));
  const double v = direction.dot(b.cross(c));
  const double w = direction.dot(c.cross(a));
  const bool is_crossed = (u > 0.0) == (v > 0.0) && (v > 0.0) == (w > 0.0);
  return is_crossed && a.dot((b - a).cross(c - a)) * (u + v + w) > 0.0;
}

}  // namespace glint
