// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which of the poses that a calibration asks for the arm can take without touching anything.
// Private to the room.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "hardware/planning/planning_cell.h"
#include "hardware/planning/view_plan.h"
#include "studies/cell/cell_file.h"

namespace glint::calibrate_cell_detail {

struct WantedPose {
  std::string name;
  Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();  ///< mm
};

struct ReachedPoses {
  ViewPlan plan;                     ///< of those that are taken, with their tour; may be empty
  std::vector<PlannedView> refused;  ///< those that were passed over, with their reasons
};

/// The first ones that `glint plan` would plan, `most` at most.
/// @param wanted  the best first
ReachedPoses reached_poses(const PlanningCell& cell,
                           std::span<const WantedPose> wanted,
                           std::size_t most);

/// Writes them as plan_file.h has plans, so that a later call drives the same.
/// @param cell  its file
void keep_poses(const ReachedPoses& poses,
                const std::filesystem::path& cell,
                const std::filesystem::path& file);

/// What keep_poses() wrote, its joints to the last digit of their degrees: each call has to drive
/// what this tells, the one that wrote it, too.
ReachedPoses kept_poses(const std::filesystem::path& file);

/// planning_cell() of a cell without a scene, with camera and board where a calibration has them.
/// @param calibration  its folder; with poses
/// @throws ConfigError, IoError
PlanningCell calibrated_cell(const Cell& cell, const std::filesystem::path& calibration);

}  // namespace glint::calibrate_cell_detail
