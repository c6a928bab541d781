// SPDX-License-Identifier: GPL-3.0-or-later
//
// An arm for KDL, whose lengths are metres.
#pragma once

#include <kdl/chain.hpp>
#include <kdl/frames.hpp>

#include "hardware/robot/kinematics/arm.h"

namespace glint::test {

inline constexpr double kMPerMm = 1e-3;

inline KDL::Chain chain_of(const Arm& arm) {
  KDL::Chain chain;
  for (const DhRow& row : arm.table()) {
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::RotZ),
                     KDL::Frame::DH(row.a_mm * kMPerMm, row.alpha_rad, row.d_mm * kMPerMm, 0.0)));
  }
  return chain;
}

inline KDL::Frame frame_of(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d r = pose.linear();
  const Eigen::Vector3d t = kMPerMm * pose.translation();
  return {KDL::Rotation(
              r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
          KDL::Vector(t.x(), t.y(), t.z())};
}

/// To 0.001 mm and 0.01 mrad.
inline bool reaches(const Arm& arm, const JointVector& joints_rad, const Eigen::Isometry3d& pose) {
  const JointVector left = pose_difference(arm.forward(joints_rad), pose);
  return left.head<3>().norm() < 1e-3 && left.tail<3>().norm() < 1e-5;
}

}  // namespace glint::test
