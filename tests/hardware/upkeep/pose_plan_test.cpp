// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/upkeep/pose_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rng.h"
#include "hardware/calibration/joint_fit.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

PlanRequest request() {
  return {.camera = {.width_px = 1224,
                     .height_px = 1025,
                     .focal_px = {1895, 1895},
                     .center_px = {612, 512}},
          .board_mm = cell_board(),
          .count = 12};
}

void expect_all_in_view(const PlanRequest& request, const PosePlan& plan) {
  const PinholeCamera camera(request.camera);
  ASSERT_EQ(plan.board_from_camera.size(), static_cast<std::size_t>(request.count));
  for (const Eigen::Isometry3d& pose : plan.board_from_camera) {
    for (const Eigen::Vector3d& point : request.board_mm) {
      const Eigen::Vector3d seen = pose.inverse() * point;
      const auto pixel = camera.project(seen);
      ASSERT_TRUE(pixel.has_value());
      EXPECT_GE(pixel->minCoeff(), request.margin_px - 1e-9);
      EXPECT_LE(pixel->x(), request.camera.width_px - request.margin_px + 1e-9);
      EXPECT_LE(pixel->y(), request.camera.height_px - request.margin_px + 1e-9);
      EXPECT_TRUE(request.near_mm == 0.0 || seen.z() >= request.near_mm);
      EXPECT_TRUE(request.far_mm == 0.0 || seen.z() <= request.far_mm);
    }
  }
}

TEST(PosePlan, ShowsTheWholeBoardInFocus) {
  PlanRequest wanted = request();
  expect_all_in_view(wanted, informative_poses(wanted));
  expect_all_in_view(wanted, strided_poses(wanted));
  wanted.near_mm = 150.0;
  wanted.far_mm = 260.0;
  expect_all_in_view(wanted, informative_poses(wanted));
  expect_all_in_view(wanted, strided_poses(wanted));
}

/// Largest tilt of the board about the picture's x (0) or y (1), as the normal in the camera says.
double largest_tilt(const PosePlan& plan, int axis) {
  double most = 0.0;
  for (const Eigen::Isometry3d& pose : plan.board_from_camera) {
    most = std::max(most, std::abs(std::asin(pose.linear().transpose()(1 - axis, 2))));
  }
  return most;
}

TEST(PosePlan, TiltsAboutBothAxes) {
  const PosePlan plan = informative_poses(request());
  EXPECT_GT(largest_tilt(plan, 0), 0.3);
  EXPECT_GT(largest_tilt(plan, 1), 0.3);
  EXPECT_LT(largest_tilt(plan, 0), 0.53);
}

/// Of all terms of the lens together: information is their product, not a single one.
TEST(PosePlan, ChosenPosesPromiseMoreThanTheSameNumberByStrides) {
  const PosePlan chosen = informative_poses(request());
  const PosePlan strided = strided_poses(request());
  EXPECT_LT(chosen.lens_sigma.array().log().mean(), strided.lens_sigma.array().log().mean());
  EXPECT_LT(chosen.hand_eye_rad, strided.hand_eye_rad);
  PlanRequest more = request();
  more.count = 24;
  EXPECT_LT(informative_poses(more).lens_sigma[0], chosen.lens_sigma[0]);
}

TEST(PosePlan, BeginsWithThePlanOfFewerPoses) {
  PlanRequest fewer = request();
  fewer.count = 5;
  const PosePlan few = informative_poses(fewer);
  const PosePlan many = informative_poses(request());
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(few.board_from_camera[i].isApprox(many.board_from_camera[i], 0.0));
  }
}

/// Tilt of the board against the view, of each pose.
std::vector<double> tilts(const PosePlan& plan) {
  std::vector<double> all;
  for (const Eigen::Isometry3d& pose : plan.board_from_camera) {
    all.push_back(std::acos(std::min(1.0, std::abs(pose.linear()(2, 2)))));
  }
  return all;
}

TEST(PosePlan, StridedPosesKeepToTheTilts) {
  PlanRequest wanted = request();
  wanted.count = 40;
  for (const double tilt : tilts(strided_poses(wanted))) {
    EXPECT_GE(tilt, wanted.tilt_min_rad - 1e-9);
    EXPECT_LE(tilt, wanted.tilt_max_rad + 1e-9);
  }
  EXPECT_GT(largest_tilt(strided_poses(wanted), 0), 0.3);
  EXPECT_GT(largest_tilt(strided_poses(wanted), 1), 0.3);
}

/// The outer squares are seen, but not measured.
TEST(PosePlan, TheOutlinePromisesNothing) {
  PlanRequest outlined = request();
  const Eigen::Vector3d last = outlined.board_mm.back();
  outlined.outline_mm = {Eigen::Vector3d(-5, -5, 0), last + Eigen::Vector3d(5, 5, 0)};
  PlanRequest measured = outlined;
  measured.board_mm.insert(
      measured.board_mm.end(), outlined.outline_mm.begin(), outlined.outline_mm.end());
  measured.outline_mm.clear();
  // The same poses, of which the one plan measures more.
  const PosePlan less = strided_poses(outlined);
  const PosePlan more = strided_poses(measured);
  ASSERT_TRUE(less.board_from_camera[0].isApprox(more.board_from_camera[0], 1e-12));
  EXPECT_GT(less.lens_sigma[0], 1.0001 * more.lens_sigma[0]);
  measured.board_mm = outlined.outline_mm;
  measured.board_mm.insert(
      measured.board_mm.begin(), outlined.board_mm.begin(), outlined.board_mm.end());
  expect_all_in_view(measured, informative_poses(outlined));
}

TEST(PosePlan, StaysWhereTheLensIsSharp) {
  PlanRequest wanted = request();
  const PosePlan anywhere = informative_poses(wanted);
  const double middle = 0.5 * (anywhere.near_mm + anywhere.far_mm);
  wanted.sharp_near_mm = 0.9 * middle;
  wanted.sharp_far_mm = 1.1 * middle;
  const PosePlan plan = informative_poses(wanted);
  EXPECT_EQ(plan.near_mm, wanted.sharp_near_mm);
  EXPECT_EQ(plan.far_mm, wanted.sharp_far_mm);
  PlanRequest told = wanted;
  told.near_mm = wanted.sharp_near_mm;
  told.far_mm = wanted.sharp_far_mm;
  expect_all_in_view(told, plan);
  // What is said explicitly overrules the lens; a lens that is sharp everywhere changes nothing.
  told.near_mm = 0.7 * middle;
  EXPECT_EQ(informative_poses(told).near_mm, told.near_mm);
  wanted.sharp_near_mm = 1.0;
  wanted.sharp_far_mm = 1e6;
  EXPECT_EQ(informative_poses(wanted).near_mm, anywhere.near_mm);
  // Sharp only beyond where the board fills enough of the picture, and without an end.
  wanted.sharp_near_mm = 1.3 * anywhere.far_mm;
  wanted.sharp_far_mm = std::numeric_limits<double>::infinity();
  const PosePlan beyond = informative_poses(wanted);
  EXPECT_EQ(beyond.near_mm, wanted.sharp_near_mm);
  EXPECT_GT(beyond.far_mm, beyond.near_mm);
}

/// Error of fx of a calibration from the planned poses, in standard deviations that were promised.
double miss_of_focal(const PlanRequest& wanted, const PosePlan& plan, std::uint64_t seed) {
  Rng rng(seed, Stream::kTest, 0);
  const NoiseSizes noise;
  const LensVector lens = lens_vector(wanted.camera);
  std::vector<BoardCorners> pictures;
  for (const Eigen::Isometry3d& pose : plan.board_from_camera) {
    BoardCorners corners{.board_mm = wanted.board_mm};
    for (const Eigen::Vector3d& point : wanted.board_mm) {
      corners.picture_px.emplace_back(*project_by_lens(lens, pose.inverse() * point, nullptr) +
                                      noise.corner_px *
                                          Eigen::Vector2d(rng.normal(), rng.normal()));
    }
    pictures.push_back(corners);
  }
  std::vector<Eigen::Isometry3d> robot;
  for (const Eigen::Isometry3d& pose : plan.board_from_camera) {
    Vector6d error;
    for (int i = 0; i < 6; ++i) {
      error[i] = (i < 3 ? noise.robot_rad : noise.robot_mm) * rng.normal();
    }
    robot.push_back(pose * motion_of(error));
  }
  LensMask all;
  all.fill(true);
  const HandEyeCalibration found =
      calibrate_hand_eye(pictures,
                         robot,
                         {.camera = {.width_px = wanted.camera.width_px,
                                     .height_px = wanted.camera.height_px,
                                     .free_terms = all}});
  EXPECT_TRUE(found.succeeded) << found.refusal;
  return (found.lens[0] - lens[0]) / plan.lens_sigma[0];
}

TEST(PosePlan, KeepsItsPromise) {
  const PlanRequest wanted = request();
  const PosePlan plan = informative_poses(wanted);
  constexpr int kTrials = 6;
  double square = 0.0;
  for (int seed = 1; seed <= kTrials; ++seed) {
    square += std::pow(miss_of_focal(wanted, plan, static_cast<std::uint64_t>(seed)), 2);
  }
  // Chi-square with 6 degrees of freedom is between 0.3 and 25 but once in 1000 times.
  EXPECT_GT(square, 0.3);
  EXPECT_LT(square, 25.0);
}

/// A narrow view whose p1 and p2 are left at 0, and nine pictures of one distance.
PlanRequest second_round() {
  PlanRequest wanted = request();
  wanted.camera.focal_px = {3600, 3600};
  wanted.near_mm = 306.0;
  wanted.far_mm = 414.0;
  PlanRequest first = wanted;
  first.count = 9;
  first.near_mm = 340.0;
  first.far_mm = 390.0;
  wanted.taken = strided_poses(first).board_from_camera;
  wanted.count = 8;
  wanted.is_free = {true, true, true, true};
  wanted.noise = {.corner_px = 0.06, .robot_rad = 7e-5, .robot_mm = 0.02};
  return wanted;
}

/// What a calibration states that leaves p1 and p2 at 0, from the pictures that there are and the
/// planned ones, of a lens that has both.
SharedCovariance stated(const PlanRequest& wanted, const PosePlan& plan) {
  Bundle bundle{.lens = lens_vector(wanted.camera),
                .is_free = wanted.is_free,
                .are_poses_free = true,
                .noise = wanted.noise};
  LensVector hidden = bundle.lens;
  hidden.tail<2>() << 8e-4, -6e-4;
  std::vector<Eigen::Isometry3d> poses = wanted.taken;
  poses.insert(poses.end(), plan.board_from_camera.begin(), plan.board_from_camera.end());
  for (const Eigen::Isometry3d& pose : poses) {
    BoardCorners corners{.board_mm = wanted.board_mm};
    for (const Eigen::Vector3d& point : wanted.board_mm) {
      corners.picture_px.push_back(*project_by_lens(hidden, pose.inverse() * point, nullptr));
    }
    bundle.views.push_back(joint_view(corners, pose));
  }
  return covariance_with_unseen(bundle);
}

double turn_of(const SharedCovariance& covariance) {
  return std::sqrt(covariance.diagonal().segment<3>(9).sum());
}

TEST(PosePlan, AimedPosesTellTheTurnThatP1AndP2LeaveOpen) {
  PlanRequest wanted = second_round();
  const double by_all = turn_of(stated(wanted, informative_poses(wanted)));
  wanted.aim_rad = 2e-4;
  wanted.aim_mm = 0.08;
  EXPECT_LT(turn_of(stated(wanted, informative_poses(wanted))), 0.95 * by_all);
}

TEST(PosePlan, ForetellsWhatACalibrationStates) {
  PlanRequest wanted = second_round();
  wanted.aim_rad = 2e-4;
  const PosePlan plan = informative_poses(wanted);
  EXPECT_NEAR(plan.before.rad / turn_of(stated(wanted, {})), 1.0, 0.01);
  ASSERT_EQ(plan.after.size(), 8U);
  const SharedCovariance covariance = stated(wanted, plan);
  EXPECT_NEAR(plan.after.back().rad / turn_of(covariance), 1.0, 0.01);
  EXPECT_NEAR(
      plan.after.back().mm / std::sqrt(covariance.diagonal().segment<3>(12).sum()), 1.0, 0.01);
  EXPECT_LT(plan.after.back().rad, 0.8 * plan.before.rad);
}

TEST(PosePlan, PromisesWithThePicturesThatThereAre) {
  PlanRequest wanted = second_round();
  const PosePlan more = informative_poses(wanted);
  wanted.taken.clear();
  const PosePlan alone = informative_poses(wanted);
  EXPECT_LT(more.lens_sigma[2], 0.9 * alone.lens_sigma[2]);
  EXPECT_TRUE(alone.after.empty());
}

TEST(PosePlan, RefusesABoardThatDoesNotFit) {
  PlanRequest wanted = request();
  wanted.near_mm = 20.0;
  wanted.far_mm = 30.0;
  EXPECT_THROW(informative_poses(wanted), ConfigError);
  EXPECT_THROW(strided_poses(wanted), ConfigError);
}

}  // namespace
}  // namespace glint
