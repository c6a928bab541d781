// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/prediction.h"

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

CameraOptions options() {
  return {.width_px = kCellWidth, .height_px = kCellHeight};
}

TEST(PredictLeftOut, IsAsGoodAsTheRobotIsAndNotBetterThanTheFit) {
  const SimulatedCell cell = simulate_cell({.num_poses = 12}, 1);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  ThreadPool pool(1);
  const Prediction alone = predict_left_out(result.bundle, options(), leave_one_out(12), pool);
  ASSERT_FALSE(alone.has_failed);
  // 0.05 mm across at 26 px/mm and 0.02 degrees at 170 mm of lever: about 2.5 px.
  EXPECT_GT(alone.rms_px, result.rms_px);
  EXPECT_GT(alone.rms_px, 1.5);
  EXPECT_LT(alone.rms_px, 4.0);
  const Prediction folds =
      predict_left_out(result.bundle, options(), shuffled_folds(12, 6, 1), pool);
  EXPECT_NEAR(folds.rms_px / alone.rms_px, 1.0, 0.4);
  const std::vector<Prediction> all =
      predict_by_all(result.bundle, options(), leave_one_out(12), pool);
  ASSERT_EQ(all.size(), 8u);
  EXPECT_EQ(all[0].rms_px, alone.rms_px);
  const Prediction& park = all[2];
  ASSERT_FALSE(park.has_failed);
  EXPECT_GT(park.rms_px, 0.8 * alone.rms_px);
}

TEST(PredictLeftOut, IsTheSameWithTwoThreads) {
  const SimulatedCell cell = simulate_cell({.num_poses = 10}, 2);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  ThreadPool one(1);
  ThreadPool two(2);
  EXPECT_EQ(predict_left_out(result.bundle, options(), leave_one_out(10), one).picture_rms_px,
            predict_left_out(result.bundle, options(), leave_one_out(10), two).picture_rms_px);
}

TEST(PredictLeftOut, FailsWhenNothingIsLeftToLearnFrom) {
  const SimulatedCell cell = simulate_cell({.num_poses = 8}, 3);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  ThreadPool pool(1);
  const std::vector<int> all_in_one(8, 0);
  EXPECT_TRUE(predict_left_out(result.bundle, options(), all_in_one, pool).has_failed);
}

TEST(PredictLeftOut, ChoosesTheLensTermsWithinTheFold) {
  const SimulatedCell cell = simulate_cell({.num_poses = 12}, 4);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  ThreadPool pool(1);
  CameraOptions given = options();
  given.free_terms = LensMask{true, true, true, true};
  Bundle poor = result.bundle;
  poor.is_free = *given.free_terms;
  poor.lens.tail<5>().setZero();
  const double plain = predict_left_out(poor, given, leave_one_out(12), pool).rms_px;
  const double chosen = predict_left_out(poor, options(), leave_one_out(12), pool).rms_px;
  // The fold may free terms that the bundle it starts from has not.
  EXPECT_LT(chosen, plain);
  EXPECT_NEAR(
      chosen, predict_left_out(result.bundle, options(), leave_one_out(12), pool).rms_px, 0.05);
}

TEST(PredictFiveFold, IsTheMeanOfItsSplits) {
  const SimulatedCell cell = simulate_cell({.num_poses = 10}, 5);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  ThreadPool pool(2);
  double sum = 0.0;
  for (const std::uint64_t seed : {1U, 2U}) {
    sum += predict_left_out(result.bundle, options(), shuffled_folds(10, 5, seed), pool).rms_px;
  }
  const std::vector<SplitMean> means = predict_five_fold(result.bundle, options(), 2, pool);
  ASSERT_EQ(means.size(), 8u);
  EXPECT_FALSE(means[0].has_failed);
  EXPECT_NEAR(means[0].rms_px, 0.5 * sum, 1e-12);
  EXPECT_GT(means[0].deviation_px, 0.0);
}

TEST(PredictCameraLeftOut, IsALittleWorseThanTheFit) {
  const SimulatedCell cell = simulate_cell({.num_poses = 12}, 6);
  const CameraCalibration solved = calibrate_camera(cell.pictures, options());
  ASSERT_TRUE(solved.succeeded) << solved.refusal;
  ThreadPool pool(2);
  const Prediction prediction =
      predict_camera_left_out(cell.pictures, solved.lens, options(), leave_one_out(12), pool);
  ASSERT_FALSE(prediction.has_failed);
  EXPECT_EQ(prediction.picture_rms_px.size(), 12u);
  // Corner noise of 0.2 px in each of two axes is 0.28 px; six numbers of the pose fit some of it.
  EXPECT_GT(prediction.rms_px, solved.rms_px);
  EXPECT_NEAR(prediction.rms_px, 0.28, 0.03);
  EXPECT_TRUE(predict_camera_left_out(cell.pictures, solved.lens, options(), leave_one_out(5), pool)
                  .has_failed);
}

}  // namespace
}  // namespace glint
