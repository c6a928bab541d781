// SPDX-License-Identifier: GPL-3.0-or-later
//
// From views to a tour of the arm: which joints, in which order, along which paths.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "hardware/planning/planning_cell.h"
#include "hardware/planning/view_plan.h"

namespace glint {

/// A view that is wanted.
struct ViewRequest {
  std::string name;
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();  ///< mm
  double target_mm = 100.0;  ///< from the pinhole to what it looks at, > 0
  /// Of a camera that stands beside the robot, at base_from_camera: where it shall be before the
  /// flange, which holds what it looks at. None: the flange carries the camera.
  std::optional<Eigen::Isometry3d> flange_from_camera = {};
};

struct PlanOptions {
  bool has_nearest = true;  ///< looks for the nearest poses of views that are refused
  bool has_tour = true;     ///< else paths are not put in order and `paths` stays empty
};

/// What planning took.
struct PlanEffort {
  std::int64_t distance_queries = 0;
};

/// Each view is judged by itself: it is planned when a branch of the inverse kinematics is accepted
/// there and has a straight free way to one of the safe positions. Then the order is sought: a
/// short round trip by estimated durations, the cheapest choice of branches for it, the ways that
/// it takes looked at, and again while that changes the durations, some times at most. Ways that
/// are not free go over safe positions.
///
/// The same input gives the same plan.
ViewPlan plan_views(const PlanningCell& cell,
                    std::span<const ViewRequest> views,
                    const PlanOptions& options = {},
                    PlanEffort* effort = nullptr);

}  // namespace glint
