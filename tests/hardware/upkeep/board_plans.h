// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well the hand-eye's rotation is known after so many pictures of boards of several sizes: the
// table of docs/theory/calibration.md, for its test and for the benchmark that prints it.
#pragma once

#include <vector>

#include "hardware/upkeep/pose_plan.h"

namespace glint {

struct PlannedBoard {
  const char* name = "";
  int cols = 0;  ///< inner corners
  int rows = 0;
  double corner_share = 1.0;  ///< of the corners' error below
  double robot_share = 1.0;   ///< of the robot's
};

inline constexpr PlannedBoard kPlannedBoards[] = {
    {.name = "10x8", .cols = 10, .rows = 8},
    {.name = "12x10", .cols = 12, .rows = 10},
    {.name = "14x11", .cols = 14, .rows = 11},
    {.name = "10x8_exact_corners", .cols = 10, .rows = 8, .corner_share = 0.1},
    {.name = "10x8_exact_robot", .cols = 10, .rows = 8, .robot_share = 1e-3}};
inline constexpr int kFirstPictures = 9;    ///< by strides
inline constexpr int kPlannedPictures = 8;  ///< in each further step

/// Squares of 3.3 mm seen at 1224 x 1025 pixels with f = 3600 px from 155 to 208 mm, corners known
/// to 0.077 px, the robot to 0.004 degree and 0.01 mm an axis; nine pictures by strides, to which
/// kPlannedPictures * steps are added that are chosen for the hand-eye's rotation.
PlanRequest board_plan_request(const PlannedBoard& board, int steps);

/// sigma_deg after the first pictures and after each further step: steps + 1 numbers.
/// Cost: some 0.2 s a step.
std::vector<double> turn_sigmas_deg(const PlannedBoard& board, int steps);

}  // namespace glint
