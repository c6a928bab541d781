// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a planner has decided: which views the arm takes, by which joints, in which order and along
// which paths.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hardware/robot/kinematics/arm.h"

namespace glint {

/// Why a view is not visited, or that it is.
enum class ViewOutcome {
  kPlanned,
  kUnreachable,  ///< no joints at all
  kJointLimit,   ///< every branch beyond the limits of joints
  kSingular,     ///< every other branch too near a singular pose
  kBox,          ///< leaves the cell's box
  kCollision,    ///< arm, camera, light or cable would touch something at the view itself
  kNoPath        ///< can be taken, but no path there is free
};

/// "planned", "unreachable", ...: as JSON has it.
std::string_view name_of(ViewOutcome outcome);

struct PlannedView {
  std::string name;
  ViewOutcome outcome = ViewOutcome::kPlanned;
  std::string reason;  ///< for people; empty when planned
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();  ///< mm
  Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();  ///< mm
  JointVector joints_rad = JointVector::Zero();  ///< of the branch that was chosen
  double margin_mm = 0.0;    ///< smallest distance of anything that moves to anything else, there
  double singularity = 0.0;  ///< singularity_measure()
  /// Of a view that is not reached: base_from_camera of the nearest one that is.
  std::optional<Eigen::Isometry3d> nearest_base_from_camera;
  /// The same of a camera beside the robot, which does not move: where the flange would be.
  std::optional<Eigen::Isometry3d> nearest_base_from_flange;
};

/// From one standstill to the next: joints in the order they are taken, both ends included, each
/// leg a movej.
struct PlannedPath {
  std::string from;  ///< name of a view or safe position
  std::string to;
  std::vector<JointVector> joints_rad;  ///< at least 2
  double margin_mm = 0.0;
  double duration_s = 0.0;
};

struct ViewPlan {
  std::vector<PlannedView> views;  ///< in the order of the scene, all of them
  std::vector<PlannedPath> paths;  ///< in the order of the tour: from a safe position, over each
                                   ///< planned view once, back to it
  double reach_share = 0.0;        ///< of views that are planned
  double reach_margin_mm = 0.0;    ///< smallest margin of the planned views and paths
};

}  // namespace glint
