// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/hand_eye_calibration.h"

#include <algorithm>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hardware/calibration/bundle_adjustment.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;

constexpr LensMask kRightTerms = {true, true, true, true, true, true, false, true, true};

HandEyeCalibration calibrate(const SimulatedCell& cell, bool chooses_terms = false) {
  HandEyeOptions options = cell_options(cell.settings);
  if (!chooses_terms) {
    options.camera.free_terms = kRightTerms;
  }
  return calibrate_hand_eye(cell.pictures, cell.base_from_flange, options);
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

class CleanCell : public testing::TestWithParam<Mounting> {};

TEST_P(CleanCell, IsSolvedExactly) {
  const SimulatedCell cell =
      simulate_cell({.mounting = GetParam(),
                     .num_poses = 12,
                     .noise = {.corner_px = 0, .robot_rad = 0, .robot_mm = 0}},
                    1);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  const auto miss = miss_of(cell, result.lens, result.poses);
  EXPECT_LT(miss.head<4>().norm(), 1e-5);
  EXPECT_LT(miss.segment<5>(4).norm(), 1e-6);
  EXPECT_LT(miss.tail<12>().norm(), 1e-6);
  EXPECT_LT(result.rms_px, 1e-6);
  EXPECT_NEAR(result.scale.factor, 1.0, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(BothMountings,
                         CleanCell,
                         testing::Values(Mounting::kEyeInHand, Mounting::kEyeToHand));

TEST(HandEyeCalibration, IsAsGoodAsTheBoundAllows) {
  std::vector<double> turn;
  std::vector<double> shift;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SimulatedCell cell = simulate_cell({}, seed);
    const HandEyeCalibration result = calibrate(cell);
    ASSERT_TRUE(result.succeeded) << result.refusal;
    const auto miss = miss_of(cell, result.lens, result.poses);
    const SharedCovariance bound = shared_covariance(bundle_at_truth(cell));
    turn.push_back(miss.segment<3>(9).norm() / std::sqrt(bound.diagonal().segment<3>(9).sum()));
    shift.push_back(miss.segment<3>(12).norm() / std::sqrt(bound.diagonal().segment<3>(12).sum()));
    // What it says of itself is what the truth says, to the errors of the estimated noise.
    EXPECT_NEAR(
        result.rotation_sigma_rad() / std::sqrt(bound.diagonal().segment<3>(9).sum()), 1.0, 0.2);
    EXPECT_NEAR(
        result.translation_sigma_mm() / std::sqrt(bound.diagonal().segment<3>(12).sum()), 1.0, 0.2);
  }
  EXPECT_LT(median(turn), 1.15);
  EXPECT_LT(median(shift), 1.15);
}

TEST(HandEyeCalibration, FindsTurnedBoardsAndWrongStampsAndSaysWhich) {
  const SimulatedCell cell = simulate_cell({.flipped_share = 0.1, .wrong_share = 0.1}, 11);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_EQ(result.orientation, BoardOrientation::kFirstPicture);
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    const HandEyePicture& picture = result.pictures[i];
    EXPECT_EQ(picture.accepted, !cell.is_wrong[i]) << i << ' ' << picture.chi_square;
    if (cell.is_wrong[i]) {
      EXPECT_THAT(picture.reason, HasSubstr("robot pose disagrees"));
    } else {
      EXPECT_EQ(picture.board_turn, cell.is_flipped[i] ? 1 : 0) << i;
    }
  }
  const auto miss = miss_of(cell, result.lens, result.poses);
  EXPECT_LT(miss.segment<3>(9).norm() * 180.0 / std::numbers::pi, 0.03);
  EXPECT_LT(miss.segment<3>(12).norm(), 0.1);
}

TEST(HandEyeCalibration, NamesTheStampThatAPictureFits) {
  SimulatedCell cell = simulate_cell({.num_poses = 20}, 12);
  std::swap(cell.base_from_flange[4], cell.base_from_flange[9]);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_FALSE(result.pictures[4].accepted);
  EXPECT_EQ(result.pictures[4].fits_pose_of, 9);
  EXPECT_EQ(result.pictures[9].fits_pose_of, 4);
}

TEST(HandEyeCalibration, WithoutRobotErrorsIsFarWorse) {
  // Negative control: poses taken as exact push the robot's error into everything else.
  const SimulatedCell cell = simulate_cell({.num_poses = 40}, 13);
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  Bundle rigid = result.bundle;
  rigid.noise = {.corner_px = 0.2, .robot_rad = 1e-7, .robot_mm = 1e-5};
  take_patterns(rigid);
  ASSERT_TRUE(adjust_bundle(rigid).has_converged);
  const double own = miss_of(cell, result.lens, result.poses).segment<3>(9).norm();
  const double other = miss_of(cell, rigid.lens, rigid.poses).segment<3>(9).norm();
  EXPECT_GT(other, 3.0 * own);
}

TEST(HandEyeCalibration, TellsThatSquaresAreLargerThanGiven) {
  SimulatedCell cell = simulate_cell({.num_poses = 30}, 14);
  for (BoardCorners& corners : cell.pictures) {
    for (Vector3d& point : corners.board_mm) {
      point /= 1.05;
    }
  }
  const HandEyeCalibration result = calibrate(cell);
  ASSERT_FALSE(result.warnings.empty()) << result.refusal;
  EXPECT_THAT(result.warnings.back(), HasSubstr("squares are 1.0"));
  EXPECT_NEAR(result.scale.factor, 1.05, 0.01);
}

/// Of squares as given nothing is told, of ones that are 1 % larger it is.
TEST(HandEyeCalibration, TellsOfSquaresOnePercentLarger) {
  for (const double factor : {1.0, 1.01}) {
    SimulatedCell cell = simulate_cell({.num_poses = 30}, 14);
    for (BoardCorners& corners : cell.pictures) {
      for (Vector3d& point : corners.board_mm) {
        point /= factor;
      }
    }
    const HandEyeCalibration result = calibrate(cell);
    const bool is_told = std::ranges::any_of(result.warnings, [](const std::string& warning) {
      return warning.find("squares are 1.0") != std::string::npos;
    });
    EXPECT_EQ(is_told, factor > 1.0) << result.scale.factor << " +- " << result.scale.sigma;
  }
}

TEST(HandEyeCalibration, KnownIntrinsicsStayAsTheyAre) {
  const SimulatedCell cell = simulate_cell({.num_poses = 20}, 15);
  HandEyeOptions options = cell_options(cell.settings);
  options.camera.known = KnownLens{.lens = cell.lens};
  const HandEyeCalibration result =
      calibrate_hand_eye(cell.pictures, cell.base_from_flange, options);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_EQ(result.lens, cell.lens);
  EXPECT_EQ(result.lens_sigma(), LensVector::Zero());
  EXPECT_LT(result.translation_sigma_mm(), calibrate(cell).translation_sigma_mm());
}

// --- Refusals ------------------------------------------------------------------------------------

TEST(HandEyeCalibration, RefusesFewerThanFivePoses) {
  const HandEyeCalibration result = calibrate(simulate_cell({.num_poses = 4}, 16));
  EXPECT_FALSE(result.succeeded);
  EXPECT_THAT(result.refusal, HasSubstr("at least 5"));
}

TEST(HandEyeCalibration, RefusesOneAxis) {
  const HandEyeCalibration result =
      calibrate(simulate_cell({.num_poses = 20, .tilt_y_deg = 0.0, .roll_deg = 0.0}, 17));
  EXPECT_FALSE(result.succeeded);
  EXPECT_THAT(result.refusal, HasSubstr("one axis"));
}

TEST(HandEyeCalibration, RefusesPosesOfOtherPictures) {
  SimulatedCell cell = simulate_cell({.num_poses = 20}, 18);
  // Every pose belongs to another picture, by steps that never repeat.
  std::vector<Isometry3d> poses = cell.base_from_flange;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    cell.base_from_flange[i] = poses[(7 * i + 3) % poses.size()];
  }
  const HandEyeCalibration result = calibrate(cell);
  EXPECT_FALSE(result.succeeded);
  EXPECT_FALSE(result.refusal.empty());
}

TEST(HandEyeCalibration, RefusesOtherNumbersAndNoRotations) {
  SimulatedCell cell = simulate_cell({.num_poses = 8}, 19);
  cell.base_from_flange.pop_back();
  EXPECT_THAT(calibrate(cell).refusal, HasSubstr("8 pictures but 7 robot poses"));
  cell = simulate_cell({.num_poses = 8}, 19);
  cell.base_from_flange[2].linear() *= 1.1;
  EXPECT_THAT(calibrate(cell).refusal, HasSubstr("robot pose 3 is no rotation"));
  cell.base_from_flange[2].translation()[0] = std::nan("");
  EXPECT_THAT(calibrate(cell).refusal, HasSubstr("robot pose 3 is no rotation"));
}

TEST(HandEyeCalibration, WeakGeometryIsCoveredByItsUncertainty) {
  // Rotations below 5 degrees: three of the errors' 12 numbers may pass 2 sigma, none 4.
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const SimulatedCell cell = simulate_cell(
        {.num_poses = 40, .tilt_x_deg = 2.5, .tilt_y_deg = 2.5, .roll_deg = 2.5}, seed);
    const HandEyeCalibration result = calibrate(cell);
    if (!result.succeeded) {
      continue;
    }
    EXPECT_FALSE(result.warnings.empty());
    const auto miss = miss_of(cell, result.lens, result.poses);
    for (Eigen::Index i = 9; i < 15; ++i) {
      EXPECT_LT(std::abs(miss[i]), 4.0 * std::sqrt(result.covariance(i, i))) << seed << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace glint
