// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/robot/kinematics/arm_poses.h"

#include "core/units.h"

namespace glint {

JointVector random_joints(std::uint64_t index) {
  Rng rng(23, Stream::kTest, index);
  JointVector joints_rad;
  for (double& angle : joints_rad) {
    angle = rng.uniform(-kPi, kPi);
  }
  return joints_rad;
}

ArmDeltas typical_deltas(ArmModel model) {
  return {.model = model,
          .serial_number = "",
          .theta_rad = {1e-3, -0.8e-3, 0.5e-3, 0.9e-3, -1e-3, 0.2e-3},
          .a_mm = {0.1, -0.3, 0.4, 0.05, -0.04, 0.0},
          .d_mm = {0.2, 210.0, -210.3, 0.4, -0.1, 0.15},
          .alpha_rad = {0.4e-3, 0.9e-3, -1e-3, 0.3e-3, -0.5e-3, 0.0}};
}

double joint_distance_rad(const JointVector& a, const JointVector& b) {
  return (a - b).unaryExpr(&wrapped_rad).cwiseAbs().maxCoeff();
}

}  // namespace glint
