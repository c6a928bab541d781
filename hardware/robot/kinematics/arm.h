// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "hardware/robot/kinematics/arm_deltas.h"
#include "hardware/robot/kinematics/closed_form.h"

namespace glint {

/// Speed of the flange by speed of the joints: rows 0 to 2 mm/s, rows 3 to 5 rad/s, in the base.
using ArmJacobian = Eigen::Matrix<double, 6, 6>;

/// A six-axis arm: where its flange is, and which joints take it there. Immutable.
class Arm {
 public:
  explicit Arm(ArmModel model) : Arm(model, ArmDeltas{}) {}

  /// @param deltas  of this one arm; all zero: the nominal arm
  Arm(ArmModel model, const ArmDeltas& deltas);

  ArmModel model() const { return model_; }

  const DhTable& table() const { return table_; }

  LinkFrames frames(const JointVector& joints_rad) const { return link_frames(table_, joints_rad); }

  /// base_from_flange, mm.
  Eigen::Isometry3d forward(const JointVector& joints_rad) const;

  ArmJacobian jacobian(const JointVector& joints_rad) const;

  /// Every branch: in closed form for the nominal arm, and by Newton's method from there for one
  /// with deltas; forward() of each gives the pose to 1e-9 mm and 1e-9 rad. Angles in (-pi, pi].
  /// With deltas a branch may be missing where singularity_measure() is below 0.001.
  ArmSolutions inverse(const Eigen::Isometry3d& base_from_flange) const;

  /// Newton's method on forward().
  /// @return joints to 1e-9 mm and 1e-9 rad; none where it does not arrive in 30 steps
  std::optional<JointVector> refined(const Eigen::Isometry3d& base_from_flange,
                                     const JointVector& start_rad) const;

 private:
  ArmModel model_;
  DhTable nominal_;
  DhTable table_;
  bool is_nominal_;
};

/// What is left between two poses: translation (mm), then rotation vector (rad), in the base.
JointVector pose_difference(const Eigen::Isometry3d& to, const Eigen::Isometry3d& from);

/// Smallest singular value of the Jacobian with its translations in metres: about 0.1 in healthy
/// poses of these arms, and 0 where the flange cannot move in every direction.
double singularity_measure(const ArmJacobian& jacobian);

/// The turns of the solution's joints by whole circles that come nearest to the reference within
/// +- limit_rad.
JointVector nearest_turns(const JointVector& solution_rad,
                          const JointVector& reference_rad,
                          double limit_rad);

/// The solution whose largest joint motion from the reference is the smallest, at its nearest
/// turns.
/// @return none when there is no solution
std::optional<JointVector> nearest_solution(const ArmSolutions& solutions,
                                            const JointVector& reference_rad,
                                            double limit_rad);

}  // namespace glint
