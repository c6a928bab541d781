// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inverse kinematics in closed form of arms with the axes of UR robots: joints 2, 3 and 4 parallel,
// 4 and 5 as well as 5 and 6 crossing at right angles, as nominal_table() has them.
//
// The wrist's offset d4 from the plane of joints 2 to 4 gives two angles of joint 1, the flange's
// axis in that plane two of joint 5, the triangle of upper arm and forearm two of joint 3: eight
// branches. Angles come from atan2 of sine and cosine, never from acos or asin of one number, so
// that nothing is lost where branches meet. Own derivation; forward(inverse) is tested to 1e-9.
#pragma once

#include <array>
#include <span>

#include "hardware/robot/kinematics/denavit_hartenberg.h"

namespace glint {

/// Up to eight sets of joint angles, each in (-pi, pi], that reach the same pose.
class ArmSolutions {
 public:
  static constexpr int kMax = 8;

  void add(const JointVector& joints_rad) {
    joints_rad_[static_cast<std::size_t>(count_)] = joints_rad;
    ++count_;
  }

  bool is_full() const { return count_ == kMax; }

  bool empty() const { return count_ == 0; }

  int size() const { return count_; }

  const JointVector& operator[](int i) const { return joints_rad_[static_cast<std::size_t>(i)]; }

  const JointVector* begin() const { return joints_rad_.data(); }

  const JointVector* end() const { return joints_rad_.data() + count_; }

 private:
  std::array<JointVector, kMax> joints_rad_;
  int count_ = 0;
};

/// The angle's equal in (-pi, pi].
double wrapped_rad(double angle_rad);

/// All branches. Where joint 6 is free (joint 5 at 0 or pi), it is the multiple of 5 degrees
/// nearest to 0 that is in reach. A pose out of reach has none.
/// @param table             nominal_table()
/// @param base_from_flange  mm; a rotation to about 1e-12
/// @param slack  how far, as share of a length, the pose may lie beyond the reach and still give
/// the
///               nearest angles instead of none: 1e-12 for solutions, more for starting points
ArmSolutions closed_form_inverse(const DhTable& table,
                                 const Eigen::Isometry3d& base_from_flange,
                                 double slack = 1e-12);

}  // namespace glint
