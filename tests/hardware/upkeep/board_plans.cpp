// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/upkeep/board_plans.h"

#include "core/units.h"

namespace glint {
namespace {

constexpr double kPlannedSquare_mm = 3.3;

Eigen::Vector3d planned_corner_mm(int col, int row) {
  return {kPlannedSquare_mm * col, kPlannedSquare_mm * row, 0.0};
}

/// Without pictures that there are.
PlanRequest empty_request(const PlannedBoard& board) {
  PlanRequest request = {.camera = {.width_px = 1224,
                                    .height_px = 1025,
                                    .focal_px = {3600, 3600},
                                    .center_px = {612, 512}},
                         .near_mm = 155.0,
                         .far_mm = 208.0,
                         .is_free = {true, true, true, true},
                         .noise = {.corner_px = 0.077 * board.corner_share,
                                   .robot_rad = 0.004 * kRadPerDeg * board.robot_share,
                                   .robot_mm = 0.01 * board.robot_share}};
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      request.board_mm.push_back(planned_corner_mm(col, row));
    }
  }
  for (const int col : {-1, board.cols}) {
    for (const int row : {-1, board.rows}) {
      request.outline_mm.push_back(planned_corner_mm(col, row));
    }
  }
  return request;
}

}  // namespace

PlanRequest board_plan_request(const PlannedBoard& board, int steps) {
  PlanRequest request = empty_request(board);
  PlanRequest first = request;
  first.count = kFirstPictures;
  first.near_mm = 165.0;
  first.far_mm = 195.0;
  request.taken = strided_poses(first).board_from_camera;
  request.count = kPlannedPictures * steps;
  request.aim_rad = 0.012 * kRadPerDeg;
  return request;
}

std::vector<double> turn_sigmas_deg(const PlannedBoard& board, int steps) {
  const PosePlan plan = informative_poses(board_plan_request(board, steps));
  std::vector<double> sigmas_deg = {plan.before.rad * kDegPerRad};
  for (std::size_t i = kPlannedPictures - 1; i < plan.after.size(); i += kPlannedPictures) {
    sigmas_deg.push_back(plan.after[i].rad * kDegPerRad);
  }
  return sigmas_deg;
}

}  // namespace glint
