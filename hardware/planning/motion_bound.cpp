// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/motion_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace glint {

double MotionBound::share_within(double motion_mm) const {
  if (motion_mm <= 0.0) {
    return 0.0;
  }
  // The root of a s + b s^2 / 2 = motion, in the form that does not cancel.
  const double root = linear_mm + std::sqrt(linear_mm * linear_mm + 2.0 * quadratic_mm * motion_mm);
  return root > 0.0 ? 2.0 * motion_mm / root : std::numeric_limits<double>::infinity();
}

MotionHull::MotionHull(const DhTable& table, int link, std::vector<Eigen::Vector3d> points_mm)
    : link_(link), points_mm_(std::move(points_mm)) {
  double extent_mm = 0.0;
  for (const Eigen::Vector3d& point_mm : points_mm_) {
    extent_mm = std::max(extent_mm, point_mm.norm());
  }
  for (int j = link - 1; j >= 0; --j) {
    const DhRow& row = table[static_cast<std::size_t>(j)];
    farthest_mm_[static_cast<std::size_t>(j)] = std::abs(row.a_mm) + extent_mm;
    extent_mm += std::hypot(row.a_mm, row.d_mm);
  }
}

MotionBound MotionHull::bound(const LinkFrames& frames,
                              const JointVector& way_rad,
                              int fixed) const {
  MotionBound bound;
  double beyond_mm = 0.0;  // sum over joints behind j of |dq_k| M_k
  const Eigen::Isometry3d& base_from_link = frames[static_cast<std::size_t>(link_)];
  for (int j = link_ - 1; j >= fixed; --j) {
    const Eigen::Isometry3d& frame = frames[static_cast<std::size_t>(j)];
    const double turn_rad = std::abs(way_rad[j]);
    double square_mm2 = 0.0;
    for (const Eigen::Vector3d& point_mm : points_mm_) {
      const Eigen::Vector3d away_mm = base_from_link * point_mm - frame.translation();
      square_mm2 = std::max(square_mm2, frame.linear().col(2).cross(away_mm).squaredNorm());
    }
    bound.linear_mm += turn_rad * std::sqrt(square_mm2);
    bound.quadratic_mm += turn_rad * beyond_mm;
    beyond_mm += turn_rad * farthest_mm_[static_cast<std::size_t>(j)];
  }
  return bound;
}

}  // namespace glint
