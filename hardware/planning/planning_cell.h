// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/units.h"
#include "hardware/planning/solid_body.h"

namespace glint {

/// Joints where the arm may wait and pass.
struct SafeJoints {
  std::string name;
  JointVector joints_rad = JointVector::Zero();
};

/// Everything that a plan depends on beside its views.
struct PlanningCell {
  ArmWithTool arm;
  Eigen::Isometry3d flange_from_camera = Eigen::Isometry3d::Identity();  ///< mm; on the flange
  std::vector<SolidBody> carried;       ///< of kind kCarried, in frame 6
  std::vector<SolidBody> standing;      ///< of kind kStanding, in frame 0
  std::optional<double> table_mm = {};  ///< height of a table that fills the cell; none: no table
  double margin_mm = 5.0;               ///< what moves stays that far from what stands; >= 0
  JointVector joint_min_rad = JointVector::Constant(-2.0 * kPi);  ///< within +- 2 pi
  JointVector joint_max_rad = JointVector::Constant(2.0 * kPi);
  double min_joint_sine = 0.05;            ///< |sin| of joints 3 and 5 at views; less is singular
  std::vector<SafeJoints> safe_positions;  ///< the first usable one begins and ends the tour
};

}  // namespace glint
