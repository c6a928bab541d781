// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/hand_eye_calibration.h"

#include <algorithm>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/median.h"
#include "hardware/calibration/bundle_adjustment.h"
#include "tests/hardware/calibration/cell_counts.h"
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

// Pictures too coarse to tell p1 and p2 take them for a turn of the camera.
TEST(HandEyeCalibration, SaysWhatTangentialTermsLeaveOpenThatItCannotSee) {
  std::vector<double> turns;
  std::vector<double> without;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const SimulatedCell cell = simulate_cell(
        {.num_poses = 17, .noise = {.corner_px = 1.6, .robot_rad = 2e-4, .robot_mm = 0.03}}, seed);
    const HandEyeCalibration result = calibrate(cell, true);
    ASSERT_TRUE(result.succeeded) << result.refusal;
    if (result.lens[7] != 0.0 || result.lens[8] != 0.0) {
      continue;
    }
    const auto miss = miss_of(cell, result.lens, result.poses);
    for (const Eigen::Index axis : {9, 10}) {
      turns.push_back(std::abs(miss[axis]) / std::sqrt(result.with_unseen(axis, axis)));
      without.push_back(std::abs(miss[axis]) / std::sqrt(result.covariance(axis, axis)));
    }
  }
  ASSERT_GE(turns.size(), 8U);
  EXPECT_LT(median(turns), 2.0);  // the truth's 1e-3 and -8e-4 are two of the prior's deviations
  EXPECT_GT(median(without), 2.4);
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
  HandEyeOptions options = cell_options(cell.settings);
  options.camera.free_terms = kRightTerms;
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    options.names.push_back("p" + std::to_string(i) + ".png");
  }
  const HandEyeCalibration result =
      calibrate_hand_eye(cell.pictures, cell.base_from_flange, options);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_FALSE(result.pictures[4].accepted);
  EXPECT_EQ(result.pictures[4].fits_pose_of, 9);
  EXPECT_EQ(result.pictures[9].fits_pose_of, 4);
  EXPECT_THAT(result.pictures[4].reason, HasSubstr("it fits the robot pose of picture p9.png"));
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

// --- Squares of another size ---------------------------------------------------------------------

/// The board is given smaller than it is.
SimulatedCell with_larger_squares(double factor, std::uint64_t seed, const CellSettings& settings) {
  SimulatedCell cell = simulate_cell(settings, seed);
  for (BoardCorners& corners : cell.pictures) {
    for (Vector3d& point : corners.board_mm) {
      point /= factor;
    }
  }
  return cell;
}

HandEyeCalibration calibrate_squares(const SimulatedCell& cell, double square_mm) {
  HandEyeOptions options = cell_options(cell.settings);
  options.camera.free_terms = kRightTerms;
  options.square_mm = square_mm;
  return calibrate_hand_eye(cell.pictures, cell.base_from_flange, options);
}

struct SquareCase {
  Mounting mounting;
  double factor;
  bool is_found;  ///< its standard deviation is about 0.1 %: 0.3 % may be chance
};

TEST(SquareSize, RejectsNoGoodPictureAndIsFound) {
  std::vector<SquareCase> cases = {{Mounting::kEyeToHand, 1.006, true},
                                   {Mounting::kEyeInHand, 0.985, true},
                                   {Mounting::kEyeInHand, 1.2, true},
                                   {Mounting::kEyeInHand, 1.003, false},
                                   {Mounting::kEyeToHand, 0.997, false}};
  cases.resize(kAllCells ? cases.size() : 1);
  for (const auto& [mounting, factor, is_found] : cases) {
    const SimulatedCell cell =
        with_larger_squares(factor, 14, {.mounting = mounting, .num_poses = 40});
    const HandEyeCalibration result = calibrate_squares(cell, 6.6);
    EXPECT_TRUE(result.has_other_squares || !is_found) << factor;
    EXPECT_NEAR(result.scale.factor, factor, 4.0 * result.scale.sigma) << factor;
    EXPECT_LT(result.scale.sigma, 0.0015) << factor;
    for (const HandEyePicture& picture : result.pictures) {
      EXPECT_TRUE(picture.accepted) << factor << ' ' << picture.reason;
    }
  }
}

TEST(SquareSize, IsTakenAndToldUpToHalfAPercent) {
  const SimulatedCell cell = with_larger_squares(1.004, 14, {.num_poses = 40});
  const HandEyeCalibration result = calibrate_squares(cell, 6.6 / 1.004);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_THAT(result.notes[0], HasSubstr("mm instead of 6.57371 mm; they are taken so"));
  // The hand-eye is that of the true board, within what the size leaves open.
  const auto miss = miss_of(cell, result.lens, result.poses);
  for (Eigen::Index i = 9; i < 15; ++i) {
    EXPECT_LT(std::abs(miss[i]), 4.0 * std::sqrt(result.covariance(i, i))) << i;
  }
}

TEST(SquareSize, IsRefusedBeyondWithWhatItWouldBe) {
  const HandEyeCalibration result =
      calibrate_squares(with_larger_squares(0.985, 14, {.num_poses = 40}), 10.15);
  EXPECT_FALSE(result.succeeded);
  // 0.985 * 10.15 = 9.998
  EXPECT_THAT(result.refusal, HasSubstr("the board's squares are 0.98"));
  EXPECT_THAT(result.refusal, testing::AnyOf(HasSubstr(": 9.99"), HasSubstr(": 10.00")));
  EXPECT_THAT(result.refusal, HasSubstr("instead of 10.15 mm"));
}

TEST(SquareSize, IsFoundBesideTurnedBoardsAndWrongStamps) {
  const SimulatedCell cell =
      with_larger_squares(1.004, 15, {.flipped_share = 0.1, .wrong_share = 0.1});
  const HandEyeCalibration result = calibrate_squares(cell, 6.6);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_TRUE(result.has_other_squares);
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    EXPECT_EQ(result.pictures[i].accepted, !cell.is_wrong[i]) << i;
  }
}

/// Of squares as given nothing is told, with few pictures and weak motions neither.
TEST(SquareSize, StaysAsGivenWhereNothingIsWrong) {
  std::vector<CellSettings> cells = {
      {.num_poses = 8},
      {.num_poses = 30},
      {.num_poses = 20, .tilt_x_deg = 4.0, .tilt_y_deg = 4.0, .roll_deg = 4.0},
      {.num_poses = 20, .shared_px = 0.3},
      {.num_poses = 40, .wrong_share = 0.1}};
  cells.resize(kAllCells ? cells.size() : 1);
  for (const CellSettings& settings : cells) {
    for (std::uint64_t seed = 50; seed < (kAllCells ? 54U : 51U); ++seed) {
      const HandEyeCalibration result = calibrate_squares(simulate_cell(settings, seed), 6.6);
      EXPECT_FALSE(result.has_other_squares)
          << seed << ' ' << result.scale.factor << " +- " << result.scale.sigma;
    }
  }
}

/// A robot that is off by 1 mm 146 mm before the board is named, and is no ruler.
TEST(SquareSize, IsNotJudgedByABadRobot) {
  const SimulatedCell cell = simulate_cell(
      {.num_poses = 30, .noise = {.corner_px = 0.2, .robot_rad = 2e-3, .robot_mm = 1.0}}, 3);
  const HandEyeCalibration result = calibrate_squares(cell, 6.6);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_FALSE(result.has_other_squares);
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_THAT(result.notes[0], HasSubstr("the robot's poses are off by "));
  EXPECT_THAT(result.notes[0], HasSubstr("the errors are the robot's, not the camera's"));
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
