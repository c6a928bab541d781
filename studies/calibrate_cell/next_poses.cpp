// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/next_poses.h"

#include <utility>

#include "hardware/planning/view_planner.h"
#include "studies/calibrate/known_calibration.h"
#include "studies/plan/plan_file.h"
#include "studies/reach/scene_cell.h"

namespace glint::calibrate_cell_detail {
namespace {

/// Its outermost squares included.
SolidBody board_body(const KnownCalibration& known) {
  const bool is_in_hand = known.mounting == Mounting::kEyeInHand;
  SolidBody body = {.name = "board"};
  body.kind = is_in_hand ? SolidBody::Kind::kStanding : SolidBody::Kind::kCarried;
  body.link = is_in_hand ? 0 : 6;
  const Board& board = known.board;
  for (const int row : {-1, board.rows}) {
    for (const int col : {-1, board.cols}) {
      body.mesh.vertices_mm.push_back(known.poses.board * corner_mm(board, col, row));
    }
  }
  body.mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  return body;
}

ViewRequest request_of(const PlanningCell& cell, const WantedPose& wanted) {
  return {.name = wanted.name,
          .base_from_camera = wanted.base_from_flange * cell.flange_from_camera};
}

/// Also those that no path leads to.
void set_refused_apart(ReachedPoses& poses) {
  std::vector<PlannedView> taken;
  for (PlannedView& view : poses.plan.views) {
    auto& views = view.outcome == ViewOutcome::kPlanned ? taken : poses.refused;
    views.push_back(std::move(view));
  }
  poses.plan.views = std::move(taken);
}

}  // namespace

ReachedPoses reached_poses(const PlanningCell& cell,
                           std::span<const WantedPose> wanted,
                           std::size_t most) {
  std::vector<ViewRequest> requests;
  for (const WantedPose& pose : wanted) {
    requests.push_back(request_of(cell, pose));
  }
  ViewPlan judged = plan_views(cell, requests, {.has_nearest = false, .has_tour = false});
  ReachedPoses reached;
  std::vector<ViewRequest> taken;
  for (std::size_t i = 0; i < requests.size() && taken.size() < most; ++i) {
    if (judged.views[i].outcome == ViewOutcome::kPlanned) {
      taken.push_back(requests[i]);
    } else {
      reached.refused.push_back(std::move(judged.views[i]));
    }
  }
  reached.plan = plan_views(cell, taken, {.has_nearest = false});
  set_refused_apart(reached);
  return reached;
}

void keep_poses(const ReachedPoses& poses,
                const std::filesystem::path& cell,
                const std::filesystem::path& file) {
  ViewPlan all = poses.plan;
  all.views.insert(all.views.end(), poses.refused.begin(), poses.refused.end());
  write_plan({.plan = std::move(all), .cell = cell}, file);
}

ReachedPoses kept_poses(const std::filesystem::path& file) {
  ReachedPoses poses = {.plan = read_plan(file).plan, .refused = {}};
  set_refused_apart(poses);
  return poses;
}

PlanningCell calibrated_cell(const Cell& cell, const std::filesystem::path& calibration) {
  Cell known = cell;
  known.calibration = calibration / "calibration.toml";
  PlanningCell planned = planning_cell(known);
  SolidBody board = board_body(read_calibration(calibration));
  auto& bodies = board.kind == SolidBody::Kind::kCarried ? planned.carried : planned.standing;
  bodies.push_back(std::move(board));
  return planned;
}

}  // namespace glint::calibrate_cell_detail
