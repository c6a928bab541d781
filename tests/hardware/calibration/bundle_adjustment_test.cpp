// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/bundle_adjustment.h"

#include <gtest/gtest.h>

#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

// One picture of a line of corners tells next to nothing, so that factorings fail.
TEST(AdjustBundle, WritesNothingWhereStepsFail) {
  const SimulatedCell cell = simulate_cell({.num_poses = 3}, 1);
  Bundle bundle = bundle_at_truth(cell);
  bundle.is_free.fill(true);
  bundle.are_poses_free = true;
  bundle.lens[0] *= 1.1;
  bundle.views.resize(1);
  bundle.noise = {.corner_px = 1e-5, .robot_rad = 1e6, .robot_mm = 1e9};
  BoardCorners& corners = bundle.views[0].corners;
  corners.board_mm.resize(4);
  corners.picture_px.resize(4);
  bundle.views[0].weights = Eigen::VectorXd::Ones(4);
  testing::internal::CaptureStderr();
  adjust_bundle(bundle);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace glint
