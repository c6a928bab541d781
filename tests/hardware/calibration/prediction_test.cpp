// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/prediction.h"

#include <gtest/gtest.h>

#include "hardware/calibration/lens_choice.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

HandEyeCalibration calibrate(const SimulatedCell& cell) {
  HandEyeOptions options = cell_options(cell.settings);
  options.camera.free_terms = LensMask{true, true, true, true, true, true, false, true, true};
  return calibrate_hand_eye(cell.pictures, cell.base_from_flange, options);
}

TEST(PredictLeftOut, IsAsGoodAsTheRobotIsAndNotBetterThanTheFit) {
  const SimulatedCell cell = simulate_cell({.num_poses = 12}, 1);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  ThreadPool pool(1);
  const Prediction alone = predict_left_out(result.bundle, leave_one_out(12), pool);
  ASSERT_FALSE(alone.has_failed);
  // 0.05 mm across at 26 px/mm and 0.02 degrees at 170 mm of lever: about 2.5 px.
  EXPECT_GT(alone.rms_px, result.rms_px);
  EXPECT_GT(alone.rms_px, 1.5);
  EXPECT_LT(alone.rms_px, 4.0);
  const Prediction folds = predict_left_out(result.bundle, shuffled_folds(12, 6, 1), pool);
  EXPECT_NEAR(folds.rms_px / alone.rms_px, 1.0, 0.4);
  const Prediction park =
      predict_left_out(result.bundle, leave_one_out(12), HandEyeMethod::kPark, pool);
  ASSERT_FALSE(park.has_failed);
  EXPECT_GT(park.rms_px, 0.8 * alone.rms_px);
}

TEST(PredictLeftOut, IsTheSameWithTwoThreads) {
  const SimulatedCell cell = simulate_cell({.num_poses = 10}, 2);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  ThreadPool one(1);
  ThreadPool two(2);
  EXPECT_EQ(predict_left_out(result.bundle, leave_one_out(10), one).picture_rms_px,
            predict_left_out(result.bundle, leave_one_out(10), two).picture_rms_px);
}

TEST(PredictLeftOut, FailsWhenNothingIsLeftToLearnFrom) {
  const SimulatedCell cell = simulate_cell({.num_poses = 8}, 3);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  ThreadPool pool(1);
  const std::vector<int> all_in_one(8, 0);
  EXPECT_TRUE(predict_left_out(result.bundle, all_in_one, pool).has_failed);
}

}  // namespace
}  // namespace glint
