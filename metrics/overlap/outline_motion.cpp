// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reweighted least squares of offset = normal . (shift + linear (at - middle)).
#include "metrics/overlap/outline_motion.h"
#include "core/median.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace glint {
namespace {

using Eigen::Vector2d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kMinOffsets = 12;
constexpr int kRounds = 12;
constexpr double kTukey = 4.685;
constexpr double kFaint = 1e-6;  ///< pull to zero of what no edge tells of

/// About what a motion is fitted.
struct Frame {
  Vector2d middle_px;
  double extent_px = 1.0;

  /// Shift, then the columns of the linear part times the extent, so that all are pixels.
  Vector6 row_of(const EdgeOffset& edge) const {
    const Vector2d from = (edge.at_px - middle_px) / extent_px;
    Vector6 row;
    row << edge.normal, edge.normal * from.x(), edge.normal * from.y();
    return row;
  }
};

/// One round of the robust fit. @param free  how many of the values are fitted
Vector6 refitted(std::span<const EdgeOffset> offsets,
                 const Frame& frame,
                 double min_scale_px,
                 Eigen::Index free,
                 const Vector6& values) {
  std::vector<double> sizes;
  for (const EdgeOffset& edge : offsets) {
    sizes.push_back(std::abs(edge.offset_px - frame.row_of(edge).dot(values)));
  }
  const double reach = kTukey * std::max(1.4826 * median(sizes), min_scale_px);
  Matrix6 normal = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double ratio = sizes[i] / reach;
    if (ratio >= 1.0) {
      continue;
    }
    const double weight = (1.0 - ratio * ratio) * (1.0 - ratio * ratio);
    const Vector6 row = frame.row_of(offsets[i]);
    normal += weight * row * row.transpose();
    right += weight * offsets[i].offset_px * row;
  }
  normal.diagonal().array() += kFaint * std::max(normal.diagonal().maxCoeff(), 1e-12);
  Vector6 fitted = Vector6::Zero();
  fitted.head(free) = normal.topLeftCorner(free, free).ldlt().solve(right.head(free));
  return fitted;
}

}  // namespace

OutlineMotion fit_outline_motion(std::span<const EdgeOffset> offsets,
                                 double min_scale_px,
                                 bool is_shift_only) {
  OutlineMotion motion;
  if (offsets.empty()) {
    return motion;
  }
  for (const EdgeOffset& edge : offsets) {
    motion.middle_px += edge.at_px / static_cast<double>(offsets.size());
  }
  double extent = 1.0;
  for (const EdgeOffset& edge : offsets) {
    extent = std::max(extent, (edge.at_px - motion.middle_px).norm());
  }
  const Eigen::Index free = is_shift_only || offsets.size() < kMinOffsets ? 2 : 6;
  Vector6 values = Vector6::Zero();
  for (int round = 0; round < kRounds; ++round) {
    values = refitted(
        offsets, {.middle_px = motion.middle_px, .extent_px = extent}, min_scale_px, free, values);
  }
  motion.shift_px = values.head<2>();
  motion.linear.col(0) = values.segment<2>(2) / extent;
  motion.linear.col(1) = values.segment<2>(4) / extent;
  return motion;
}

std::vector<Boundary> moved_outlines(std::vector<Boundary> outlines, const OutlineMotion& motion) {
  for (Boundary& outline : outlines) {
    for (BoundaryPoint& point : outline.points) {
      point.at_px = motion.moved(point.at_px);
    }
  }
  return outlines;
}

}  // namespace glint
