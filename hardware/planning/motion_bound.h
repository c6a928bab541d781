// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a body can move while the joints go along a straight line: what lets a path be checked
// with as few looks as possible and yet without a gap between them.
//
// Along q(s) = q0 + s dq a point moves, relative to the link `fixed`, at most
//
//     integral of  sum over joints j with fixed < j <= link of  |dq_j| R_j(s)  ds,
//
// R_j its distance from the axis of joint j. Joints before j do not change R_j, those behind it
// change it at most as fast as they move the point: R_j(s) <= R_j(0) + s sum_{k > j} |dq_k| M_k,
// M_k the largest distance from axis k that the links between allow. So from s = 0 on
//
//     motion <= a s + b s^2 / 2,   a = sum |dq_j| R_j(0),   b = sum |dq_j| sum_{k > j} |dq_k| M_k.
//
// Own derivation; points of a convex hull are the farthest from any axis, so that its corners
// stand for the body.
#pragma once

#include <array>
#include <vector>

#include "hardware/robot/kinematics/arm.h"

namespace glint {

/// a and b of the bound, mm.
struct MotionBound {
  double linear_mm = 0.0;
  double quadratic_mm = 0.0;

  /// Motion over a share of the way.
  double over(double share) const { return share * (linear_mm + 0.5 * share * quadratic_mm); }

  /// The share of the way over which the motion is at most so large. Infinity where nothing moves.
  double share_within(double motion_mm) const;
};

/// A body as the bound sees it.
class MotionHull {
 public:
  /// @param points_mm  that enclose the body, in its link's frame
  MotionHull(const DhTable& table, int link, std::vector<Eigen::Vector3d> points_mm);

  int link() const { return link_; }

  const std::vector<Eigen::Vector3d>& points_mm() const { return points_mm_; }

  /// @param fixed  0 to link: the motion is relative to that frame
  MotionBound bound(const LinkFrames& frames, const JointVector& way_rad, int fixed) const;

 private:
  int link_;
  std::vector<Eigen::Vector3d> points_mm_;
  std::array<double, 6> farthest_mm_ = {};  ///< from the axis of each joint, in any pose
};

}  // namespace glint
