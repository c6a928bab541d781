// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures and poses that are wrong as a whole: refused with what is wrong, or covered by the
// uncertainty that is told.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "hardware/calibration/moved_board.h"
#include "tests/hardware/calibration/cell_counts.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

constexpr LensMask kCellTerms = {true, true, true, true, true, true, false, true, true};

HandEyeCalibration solve(const SimulatedCell& cell) {
  HandEyeOptions options = cell_options(cell.settings);
  options.camera.free_terms = kCellTerms;
  return calibrate_hand_eye(cell.pictures, cell.base_from_flange, options);
}

// --- Poses ---------------------------------------------------------------------------------------

TEST(BadPoses, MetresTakenForMillimetresAreRefused) {
  for (const double factor : {1e-3, 1e3}) {
    SimulatedCell cell = simulate_cell({.num_poses = 20}, 21);
    for (Eigen::Isometry3d& pose : cell.base_from_flange) {
      pose.translation() *= factor;
    }
    const HandEyeCalibration result = solve(cell);
    EXPECT_FALSE(result.succeeded) << factor;
    EXPECT_THAT(result.refusal, HasSubstr("other order, unit, direction or rotation")) << factor;
  }
}

TEST(BadPoses, DegreesTakenForRadiansAreRefused) {
  for (const double factor : {kDegPerRad, kRadPerDeg}) {
    SimulatedCell cell = simulate_cell({.num_poses = 20}, 22);
    for (Eigen::Isometry3d& pose : cell.base_from_flange) {
      pose.linear() = rotation_of(factor * rotation_vector_rad(pose.linear()));
    }
    const HandEyeCalibration result = solve(cell);
    EXPECT_FALSE(result.succeeded) << factor;
    EXPECT_FALSE(result.refusal.empty());
  }
}

TEST(BadPoses, InverseDirectionIsRefused) {
  SimulatedCell cell = simulate_cell({.num_poses = 20}, 23);
  for (Eigen::Isometry3d& pose : cell.base_from_flange) {
    pose = pose.inverse();
  }
  EXPECT_FALSE(solve(cell).succeeded);
}

TEST(BadPoses, ADoubledStampIsRejectedAndNamed) {
  SimulatedCell cell = simulate_cell({.num_poses = 20}, 24);
  cell.base_from_flange[7] = cell.base_from_flange[6];
  const HandEyeCalibration result = solve(cell);
  ASSERT_TRUE(result.succeeded) << result.refusal;
  EXPECT_TRUE(result.pictures[6].accepted);
  EXPECT_FALSE(result.pictures[7].accepted);
  EXPECT_THAT(result.pictures[7].reason, HasSubstr("robot pose disagrees"));
}

TEST(BadPoses, OneStampForAllIsRefused) {
  SimulatedCell cell = simulate_cell({.num_poses = 10}, 25);
  for (Eigen::Isometry3d& pose : cell.base_from_flange) {
    pose = cell.base_from_flange[0];
  }
  EXPECT_THAT(solve(cell).refusal, HasSubstr("turned by at most 0.00 degrees"));
}

TEST(BadPoses, AreNoRotations) {
  const auto refusal_with = [](const auto& spoil) {
    SimulatedCell cell = simulate_cell({.num_poses = 8}, 26);
    spoil(cell.base_from_flange[4]);
    return solve(cell).refusal;
  };
  const auto is_told = HasSubstr("robot pose 5 is no rotation and translation");
  EXPECT_THAT(refusal_with([](auto& pose) { pose.linear().col(0) *= -1.0; }), is_told);
  EXPECT_THAT(refusal_with([](auto& pose) { pose.linear().setZero(); }), is_told);
  EXPECT_THAT(refusal_with([](auto& pose) { pose.linear()(1, 2) += 0.1; }), is_told);
  EXPECT_THAT(refusal_with([](auto& pose) { pose.linear()(1, 2) = std::nan(""); }), is_told);
  EXPECT_THAT(refusal_with([](auto& pose) {
                pose.translation()[1] = std::numeric_limits<double>::infinity();
              }),
              is_told);
}

// --- The board -----------------------------------------------------------------------------------

/// The board 5 mm and 2 degrees elsewhere from a picture on.
SimulatedCell moved_from(std::size_t first_after, Mounting mounting) {
  SimulatedCell cell = simulate_cell({.mounting = mounting, .num_poses = 24}, 27);
  Vector6d six;
  six << 0.0, 0.0, 2.0 * kRadPerDeg, 3.0, 4.0, 0.0;
  // What the robot would report had the board stayed: the pictures stay as they are.
  const Eigen::Isometry3d change = cell.poses.board * motion_of(six) * cell.poses.board.inverse();
  for (std::size_t i = first_after; i < cell.pictures.size(); ++i) {
    Eigen::Isometry3d& pose = cell.base_from_flange[i];
    pose = mounting == Mounting::kEyeInHand ? change * pose : pose * change.inverse();
  }
  return cell;
}

TEST(MovedBoard, IsRefusedWithThePlaceAndTheWay) {
  for (const Mounting mounting : {Mounting::kEyeInHand, Mounting::kEyeToHand}) {
    for (const std::size_t first_after :
         kAllCells ? std::vector<std::size_t>{8, 12, 17} : std::vector<std::size_t>{12}) {
      const HandEyeCalibration result = solve(moved_from(first_after, mounting));
      EXPECT_FALSE(result.succeeded);
      EXPECT_THAT(result.refusal,
                  HasSubstr("moved between pictures " + std::to_string(first_after) + " and " +
                            std::to_string(first_after + 1)));
    }
  }
}

TEST(MovedBoard, IsNotSeenWhereNothingMoved) {
  for (std::uint64_t seed = 1; seed <= (kAllCells ? 5U : 1U); ++seed) {
    const SimulatedCell cell =
        simulate_cell({.num_poses = 24, .flipped_share = 0.1, .wrong_share = 0.1}, seed);
    std::vector<PosePair> pairs;
    const CameraCalibration camera = calibrate_camera(cell.pictures, cell_options({}).camera);
    for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
      pairs.push_back({.base_from_flange = cell.base_from_flange[i],
                       .camera_from_board = camera.pictures[i].camera_from_board});
    }
    const BoardSymmetry symmetry = {.turns = 2, .center_mm = {29.7, 23.1, 0.0}, .radius_mm = 22.0};
    EXPECT_FALSE(find_moved_board(Mounting::kEyeInHand, pairs, symmetry, 1).has_value()) << seed;
  }
}

TEST(MovedBoard, TellsHowFar) {
  const SimulatedCell cell = moved_from(10, Mounting::kEyeInHand);
  const HandEyeCalibration result = solve(cell);
  // 3 mm and 4 mm are 5 mm at the board's origin; its middle, 37.6 mm away, turns with it.
  // (3, 4) + (R - 1) (29.7, 23.1) = (2.18, 5.02): 5.47 mm, less what the poses' noise makes of it.
  EXPECT_THAT(result.refusal, AnyOf(HasSubstr("by 5.4"), HasSubstr("by 5.5")));
  EXPECT_THAT(result.refusal,
              AnyOf(HasSubstr("and 2 degrees"), HasSubstr("and 1.9"), HasSubstr("and 2.0")));
}

TEST(WrongSquares, OfTwiceTheSizeAreToldByHowMuch) {
  SimulatedCell cell = simulate_cell({.num_poses = 30}, 28);
  for (BoardCorners& corners : cell.pictures) {
    for (Eigen::Vector3d& point : corners.board_mm) {
      point *= 1.2;
    }
  }
  const HandEyeCalibration result = solve(cell);
  EXPECT_FALSE(result.succeeded);
  // 1 / 1.2 = 0.833
  EXPECT_THAT(result.refusal, HasSubstr("the board's squares are 0.83"));
}

// --- Weak geometry -------------------------------------------------------------------------------

/// How often the intervals of weak geometry hold the truth: monte_carlo_slow_test.cpp.
TEST(WeakGeometry, OfFivePosesIsRefusedOrCoveredByItsUncertainty) {
  const SimulatedCell cell = simulate_cell({.num_poses = 5}, 100);
  const HandEyeCalibration result = solve(cell);
  EXPECT_EQ(result.succeeded, result.refusal.empty());
  const auto miss = miss_of(cell, result.lens, result.poses);
  for (Eigen::Index i = 9; result.succeeded && i < 15; ++i) {
    EXPECT_LT(std::abs(miss[i]), 5.0 * std::sqrt(result.covariance(i, i))) << i;
  }
}

TEST(WeakGeometryWarnings, NameWhatIsMissing) {
  const HandEyeCalibration flat = solve(simulate_cell(
      {.num_poses = 30, .tilt_x_deg = 2.0, .tilt_y_deg = 2.0, .distance_mm = 3.0, .spread_mm = 4.0},
      30));
  const bool is_told =
      !flat.succeeded || std::ranges::any_of(flat.warnings, [](const std::string& warning) {
        return warning.find("tilted by at most") != std::string::npos;
      });
  EXPECT_TRUE(is_told) << flat.refusal;
}

}  // namespace
}  // namespace glint
