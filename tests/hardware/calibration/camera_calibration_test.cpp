// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/camera_calibration.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hardware/calibration/lens_choice.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

using testing::HasSubstr;

const CameraOptions kOptions = {.width_px = kCellWidth, .height_px = kCellHeight};
constexpr LensMask kTrueTerms = {true, true, true, true, true, true, false, true, true};
constexpr NoiseSizes kNone = {.corner_px = 0.0, .robot_rad = 0.0, .robot_mm = 0.0};

CameraOptions with_terms(const LensMask& mask) {
  CameraOptions options = kOptions;
  options.free_terms = mask;
  return options;
}

TEST(CalibrateCamera, IsExactOnCleanCorners) {
  const SimulatedCell cell = simulate_cell({.num_poses = 8, .noise = kNone}, 1);
  const CameraCalibration result = calibrate_camera(cell.pictures, with_terms(kTrueTerms));
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_LT((result.lens - cell.lens).head<4>().norm(), 1e-5);
  EXPECT_LT((result.lens - cell.lens).tail<5>().norm(), 1e-7);
  EXPECT_LT(result.rms_px, 1e-7);
}

TEST(CalibrateCamera, ErrorsAreAsLargeAsItSays) {
  // Of 4 cells x 8 numbers about 10 pass 1 sigma and 1 or 2 pass 2 sigma; none may pass 4.
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const SimulatedCell cell = simulate_cell({.num_poses = 30}, seed);
    const CameraCalibration result = calibrate_camera(cell.pictures, with_terms(kTrueTerms));
    ASSERT_TRUE(result.succeeded) << result.refusal;
    // 4800 rows less 188 unknowns: known to 1 %.
    EXPECT_NEAR(result.corner_sigma_px, 0.2, 0.008);
    for (Eigen::Index i = 0; i < 9; ++i) {
      if (kTrueTerms[static_cast<std::size_t>(i)]) {
        const double off = (result.lens[i] - cell.lens[i]) / result.sigma()[i];
        EXPECT_LT(std::abs(off), 4.0) << kLensNames[static_cast<std::size_t>(i)];
        sum += off * off / 32.0;
      }
    }
  }
  EXPECT_GT(sum, 0.3);
  EXPECT_LT(sum, 2.2);
}

TEST(CalibrateCamera, TakesTangentialTermsWhereTheyPredict) {
  const SimulatedCell cell = simulate_cell({.num_poses = 20}, 5);
  const CameraCalibration result = calibrate_camera(cell.pictures, kOptions);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_EQ(result.choices.size(), 8u);
  EXPECT_TRUE(result.is_free[7] && result.is_free[8]);
  // The principal point would be wrong by 10 px without them.
  EXPECT_LT((result.lens - cell.lens).segment<2>(2).norm(), 3.0);
  LensMask radial = kTrueTerms;
  radial[7] = radial[8] = false;
  const CameraCalibration without = calibrate_camera(cell.pictures, with_terms(radial));
  EXPECT_GT((without.lens - cell.lens).segment<2>(2).norm(), 5.0);
}

TEST(CalibrateCamera, LimitsASingleWrongCorner) {
  SimulatedCell cell = simulate_cell({.num_poses = 12}, 6);
  const CameraCalibration clean = calibrate_camera(cell.pictures, with_terms(kTrueTerms));
  cell.pictures[3].picture_px[7].x() += 13.8;
  const CameraCalibration result = calibrate_camera(cell.pictures, with_terms(kTrueTerms));
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_TRUE(result.pictures[3].accepted);
  EXPECT_LT(std::abs(result.lens[0] - clean.lens[0]), 0.3 * clean.sigma()[0]);
}

TEST(CalibrateCamera, RejectsAPictureThatFitsNoPose) {
  SimulatedCell cell = simulate_cell({.num_poses = 12}, 7);
  for (std::size_t i = 0; i < 40; ++i) {  // half of the board moved
    cell.pictures[5].picture_px[i].y() += 9.0;
  }
  const CameraCalibration result = calibrate_camera(cell.pictures, with_terms(kTrueTerms));
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_FALSE(result.pictures[5].accepted);
  EXPECT_THAT(result.pictures[5].reason, HasSubstr("fit no pose"));
  EXPECT_TRUE(result.pictures[4].accepted);
}

TEST(CalibrateCamera, PriorHoldsWhatPicturesDoNotTell) {
  // One square view: focal length and distance are the prior's business.
  SimulatedCell cell = simulate_cell({.num_poses = 1, .tilt_x_deg = 0.0, .tilt_y_deg = 0.0}, 8);
  CameraOptions options = kOptions;
  options.known = KnownLens{.lens = cell.lens, .sigma = LensVector::Constant(1e-4)};
  (*options.known->sigma).head<4>().setConstant(5.0);
  options.free_terms = LensMask{true, true, true, true};
  for (int i = 0; i < 2; ++i) {
    cell.pictures.push_back(cell.pictures[0]);
  }
  const CameraCalibration result = calibrate_camera(cell.pictures, options);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_LT(std::abs(result.lens[0] - cell.lens[0]), 10.0);
  EXPECT_NEAR(result.sigma()[0], 5.0, 1.6);
  EXPECT_EQ(result.lens.tail<5>(), cell.lens.tail<5>());
}

TEST(CalibrateCamera, RefusesWhatCannotBeSolved) {
  SimulatedCell cell = simulate_cell({.num_poses = 6}, 9);
  EXPECT_THAT(calibrate_camera(cell.pictures, {}).refusal, HasSubstr("size of the pictures"));
  std::vector<BoardCorners> two(cell.pictures.begin(), cell.pictures.begin() + 2);
  EXPECT_THAT(calibrate_camera(two, kOptions).refusal, HasSubstr("at least 3"));
  EXPECT_FALSE(calibrate_camera({}, kOptions).succeeded);
  two.push_back({.board_mm = {{0, 0, 0}}, .picture_px = {{5, 5}}});
  const CameraCalibration few = calibrate_camera(two, kOptions);
  EXPECT_THAT(few.pictures[2].reason, HasSubstr("has 1 corners"));
}

TEST(CalibrateCamera, RefusesFlatViewsAndSaysWhatToTilt) {
  SimulatedCell cell =
      simulate_cell({.num_poses = 6, .tilt_x_deg = 0.0, .tilt_y_deg = 0.0, .distance_mm = 0.0}, 10);
  const CameraCalibration result = calibrate_camera(cell.pictures, with_terms(kTrueTerms));
  EXPECT_FALSE(result.succeeded);
  EXPECT_THAT(result.refusal, HasSubstr("tilt"));
}

TEST(ShuffledFolds, AreEquallyLargeAndFollowTheSeed) {
  const std::vector<int> folds = shuffled_folds(17, 5, 1);
  for (int fold = 0; fold < 5; ++fold) {
    const auto count = std::ranges::count(folds, fold);
    EXPECT_TRUE(count == 3 || count == 4);
  }
  EXPECT_EQ(folds, shuffled_folds(17, 5, 1));
  EXPECT_NE(folds, shuffled_folds(17, 5, 2));
}

}  // namespace
}  // namespace glint
