// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/view_influence.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "hardware/calibration/bundle_adjustment.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

constexpr LensMask kTerms = {true, true, true, true, true, true, false, true, true};

HandEyeCalibration calibrated_by_terms(const SimulatedCell& cell) {
  HandEyeOptions options = cell_options(cell.settings);
  options.camera.free_terms = kTerms;
  return calibrate_hand_eye(cell.pictures, cell.base_from_flange, options);
}

TEST(ViewInfluences, AreTheMovesThatLeavingAPictureOutMakes) {
  const SimulatedCell cell = simulate_cell({.num_poses = 12}, 1);
  const HandEyeCalibration result = calibrated_by_terms(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  const std::vector<ViewInfluence> influences = view_influences(result.bundle);
  ASSERT_EQ(influences.size(), 12u);
  for (const std::size_t left_out : {0u, 5u, 11u}) {
    Bundle rest = result.bundle;
    rest.views.erase(rest.views.begin() + static_cast<std::ptrdiff_t>(left_out));
    take_patterns(rest);
    ASSERT_TRUE(adjust_bundle(rest).has_converged);
    const Vector6d move = six_of(result.poses.hand_eye.inverse() * rest.poses.hand_eye);
    EXPECT_NEAR(influences[left_out].rotation_rad / move.head<3>().norm(), 1.0, 0.1) << left_out;
    EXPECT_NEAR(influences[left_out].translation_mm / move.tail<3>().norm(), 1.0, 0.1) << left_out;
    EXPECT_NEAR(
        influences[left_out].center_px / (rest.lens - result.lens).segment<2>(2).norm(), 1.0, 0.1);
  }
}

TEST(ViewInfluences, OfAMeanAreAsCookSays) {
  // One unknown, fx, that each of n equal pictures measures as fx + e_i. Leaving out picture i
  // moves the mean by -e_i / (n - 1), the variance of the mean is s^2 / n: D_i = n e_i^2 / (s (n -
  // 1))^2. Here only the order and the sum's scale are looked at, as poses take a part of each e_i.
  SimulatedCell cell = simulate_cell({.num_poses = 10, .noise = {.corner_px = 0.05}}, 2);
  for (Eigen::Vector2d& pixel : cell.pictures[4].picture_px) {
    pixel += Eigen::Vector2d(0.0004 * (pixel.x() - 1200.0), 0.0);
  }
  CameraOptions options = {.width_px = kCellWidth, .height_px = kCellHeight, .free_terms = kTerms};
  const CameraCalibration result = calibrate_camera(cell.pictures, options);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  const std::vector<ViewInfluence> influences = view_influences(result.bundle);
  const auto most = std::ranges::max_element(influences, {}, &ViewInfluence::cook);
  EXPECT_EQ(most - influences.begin(), 4);
  EXPECT_GT(most->cook, 0.5);
  EXPECT_GT(most->focal_px, 0.0);
  EXPECT_EQ(most->rotation_rad, 0.0);
}

TEST(ViewInfluences, AreInfiniteWhereNothingIsLeft) {
  const SimulatedCell cell = simulate_cell({.num_poses = 6}, 3);
  Bundle alone = bundle_at_truth(cell);
  alone.views.resize(1);
  const std::vector<ViewInfluence> influences = view_influences(alone);
  ASSERT_EQ(influences.size(), 1u);
  EXPECT_TRUE(std::isinf(influences[0].cook));
}

}  // namespace
}  // namespace glint
