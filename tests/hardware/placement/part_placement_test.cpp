// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/placement/part_placement.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Isometry3d some_pose() {
  Vector6d six;
  six << 0.3, -0.5, 1.1, 400.0, -250.0, 90.0;
  return motion_of(six);
}

/// Corners of a square of side 2 a about the part's origin.
std::vector<Vector3d> square(double a) {
  return {{a, a, 0.0}, {-a, a, 0.0}, {-a, -a, 0.0}, {a, -a, 0.0}};
}

std::vector<Vector3d> in_base(const std::vector<Vector3d>& part, const Isometry3d& pose) {
  std::vector<Vector3d> base;
  for (const Vector3d& point : part) {
    base.push_back(pose * point);
  }
  return base;
}

Vector3d random_vector(Rng& rng) {
  const double x = rng.normal();
  const double y = rng.normal();
  return {x, y, rng.normal()};
}

double chi_square(const PlacedPart& placed, const Isometry3d& truth) {
  const Vector6d miss = six_of(placed.base_from_part.inverse() * truth);
  return miss.dot(placed.covariance.ldlt().solve(miss));
}

// --- Touched points ------------------------------------------------------------------------------

TEST(PlaceByPoints, IsExactOnExactPoints) {
  const std::vector<Vector3d> part = {{0, 0, 0}, {100, 0, 0}, {0, 60, 5}};
  const auto placed = place_by_points(part, in_base(part, some_pose()), 0.1);
  ASSERT_TRUE(placed.has_value());
  EXPECT_TRUE(placed->base_from_part.isApprox(some_pose(), 1e-12));
  EXPECT_LT(placed->rms, 1e-10);
}

TEST(PlaceByPoints, CovarianceOfASquareIsAsWorkedByHand) {
  // Four points at (+-50, +-50, 0), sigma 0.2: translation 0.2^2 / 4 = 0.01 along each axis;
  // rotation about x moves them by y: 0.2^2 / (4 * 50^2) = 4e-6; about z by the distance from the
  // middle: 0.2^2 / (8 * 50^2) = 2e-6.
  const std::vector<Vector3d> part = square(50.0);
  const auto placed = place_by_points(part, in_base(part, some_pose()), 0.2);
  ASSERT_TRUE(placed.has_value());
  Vector6d variances;
  variances << 4e-6, 4e-6, 2e-6, 0.01, 0.01, 0.01;
  EXPECT_TRUE(placed->covariance.isApprox(Matrix6d(variances.asDiagonal()), 1e-9))
      << placed->covariance;
  EXPECT_NEAR(placed->translation_sigma_mm(), std::sqrt(0.03), 1e-9);
  EXPECT_NEAR(placed->rotation_sigma_rad(), std::sqrt(1e-5), 1e-12);
}

TEST(PlaceByPoints, CovarianceHoldsInAThousandTrials) {
  Rng rng(1, Stream::kTest, 0);
  const std::vector<Vector3d> part = {
      {0, 0, 0}, {120, 0, 0}, {0, 60, 5}, {80, 70, -30}, {10, 9, 40}};
  double sum = 0.0;
  double estimated = 0.0;
  for (int trial = 0; trial < 1000; ++trial) {
    std::vector<Vector3d> base = in_base(part, some_pose());
    for (Vector3d& point : base) {
      point += 0.3 * random_vector(rng);
    }
    sum += chi_square(*place_by_points(part, base, 0.3), some_pose()) / 1000.0;
    estimated += std::pow(place_by_points(part, base, std::nullopt)->translation_sigma_mm() /
                              place_by_points(part, base, 0.3)->translation_sigma_mm(),
                          2) /
                 1000.0;
  }
  // Chi-square of six degrees of freedom: 6 +- sqrt(12 / 1000) = 0.11.
  EXPECT_NEAR(sum, 6.0, 0.45);
  EXPECT_NEAR(estimated, 1.0, 0.1);
}

TEST(PlaceByPoints, NeedsThreePointsThatAreNotOnALine) {
  const std::vector<Vector3d> line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}};
  EXPECT_FALSE(place_by_points(line, line, 0.1).has_value());
  const std::vector<Vector3d> two = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(place_by_points(two, two, 0.1).has_value());
  const std::vector<Vector3d> three = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_TRUE(place_by_points(three, three, 0.1).has_value());
  EXPECT_FALSE(place_by_points(three, three, std::nullopt).has_value());
  EXPECT_FALSE(place_by_points(three, two, 0.1).has_value());
  std::vector<Vector3d> broken = three;
  broken[1].x() = std::nan("");
  EXPECT_FALSE(place_by_points(three, broken, 0.1).has_value());
}

// --- A board at a known offset -------------------------------------------------------------------

TEST(PlaceByBoard, LeverMakesAngleToDistance) {
  // 1 mrad about z at 100 mm along x is 0.1 mm along y, turned with the part by 90 degrees: -x.
  Isometry3d offset = Isometry3d::Identity();
  offset.linear() = rotation_of(0.5 * std::numbers::pi * Vector3d::UnitZ());
  offset.translation() = Vector3d(100.0, 0.0, 0.0);
  Matrix6d board = Matrix6d::Zero();
  board(2, 2) = 1e-6;
  Matrix6d known = Matrix6d::Zero();
  known(5, 5) = 0.04;
  const PlacedPart placed = place_by_board(some_pose(), board, offset, known);
  EXPECT_TRUE(placed.base_from_part.isApprox(some_pose() * offset));
  EXPECT_NEAR(placed.covariance(2, 2), 1e-6, 1e-15);
  EXPECT_NEAR(placed.covariance(3, 3), 0.01, 1e-12);
  EXPECT_NEAR(placed.covariance(2, 3), 1e-4, 1e-12);
  EXPECT_NEAR(placed.covariance(4, 4), 0.0, 1e-12);
  EXPECT_NEAR(placed.covariance(5, 5), 0.04, 1e-12);
}

TEST(PlaceByBoard, CovarianceIsThatOfTheMovedBoard) {
  const Isometry3d offset = some_pose().inverse();
  Vector6d small;
  small << 1e-6, -2e-6, 3e-6, 4e-4, 5e-4, -6e-4;
  const PlacedPart placed =
      place_by_board(some_pose(), small * small.transpose(), offset, Matrix6d::Zero());
  const Vector6d move =
      six_of(placed.base_from_part.inverse() * some_pose() * motion_of(small) * offset);
  EXPECT_TRUE(placed.covariance.isApprox(move * move.transpose(), 1e-4));
}

// --- Pictures ------------------------------------------------------------------------------------

/// The simulated cell's camera and poses, its board's place taken by a part with points in depth.
struct PartScene {
  PlacingCamera camera;
  Isometry3d base_from_part = Isometry3d::Identity();
  std::vector<PartPicture> pictures;
  Isometry3d start = Isometry3d::Identity();
};

std::vector<Vector3d> part_points() {
  return {{0, 0, 0}, {55, 0, 0}, {0, 42, 0}, {55, 42, 0}, {20, 20, 12}, {40, 10, 12}, {10, 35, -8}};
}

PartScene part_scene(int num_pictures, bool has_edges) {
  const SimulatedCell cell = simulate_cell({.num_poses = num_pictures}, 5);
  PartScene scene;
  scene.camera = {.lens = cell.lens,
                  .hand_eye = cell.poses.hand_eye,
                  .robot_rad = cell.settings.noise.robot_rad,
                  .robot_mm = cell.settings.noise.robot_mm};
  scene.base_from_part = cell.poses.board;
  Vector6d off;
  off << 0.02, -0.03, 0.02, 1.5, -1.0, 2.0;
  scene.start = cell.poses.board * motion_of(off);
  for (const Isometry3d& pose : cell.true_base_from_flange) {
    PartPicture& picture = scene.pictures.emplace_back();
    picture.base_from_flange = pose;
    const Isometry3d seen = camera_from_board(Mounting::kEyeInHand, cell.poses, pose);
    for (const Vector3d& point : part_points()) {
      picture.part_mm.push_back(point);
      picture.picture_px.push_back(*project_by_lens(cell.lens, seen * point, nullptr));
      if (has_edges) {
        const double angle = 2.4 * static_cast<double>(picture.part_mm.size());
        picture.normals.emplace_back(std::cos(angle), std::sin(angle));
      }
    }
  }
  return scene;
}

/// Pictures and poses with the errors that the scene's camera names.
std::vector<PartPicture> noisy(const PartScene& scene, double sigma_px, Rng& rng) {
  std::vector<PartPicture> pictures = scene.pictures;
  for (PartPicture& picture : pictures) {
    Vector6d error;
    error << scene.camera.robot_rad * random_vector(rng),
        scene.camera.robot_mm * random_vector(rng);
    picture.base_from_flange = picture.base_from_flange * motion_of(error).inverse();
    for (Vector2d& pixel : picture.picture_px) {
      const double x = sigma_px * rng.normal();
      pixel += Vector2d(x, sigma_px * rng.normal());
    }
  }
  return pictures;
}

class PlaceByPictures : public testing::TestWithParam<bool> {};

TEST_P(PlaceByPictures, IsExactOnExactPictures) {
  const PartScene scene = part_scene(3, GetParam());
  const auto placed = place_by_pictures(scene.camera, scene.pictures, scene.start, 0.2);
  ASSERT_TRUE(placed.has_value());
  EXPECT_LT(six_of(placed->base_from_part.inverse() * scene.base_from_part).norm(), 1e-6);
  EXPECT_LT(placed->rms, 1e-6);
}

TEST_P(PlaceByPictures, CovarianceHolds) {
  const PartScene scene = part_scene(3, GetParam());
  Rng rng(2, Stream::kTest, 0);
  double sum = 0.0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    // A calibration that misses its hand-eye as it says.
    PartScene known = scene;
    Vector6d miss;
    miss << 2e-4 * random_vector(rng), 0.05 * random_vector(rng);
    known.camera.hand_eye = scene.camera.hand_eye * motion_of(miss);
    known.camera.covariance.diagonal().segment<3>(9).setConstant(4e-8);
    known.camera.covariance.diagonal().tail<3>().setConstant(0.0025);
    const auto placed = place_by_pictures(known.camera, noisy(scene, 0.2, rng), scene.start, 0.2);
    ASSERT_TRUE(placed.has_value()) << trial;
    sum += chi_square(*placed, scene.base_from_part) / kTrials;
  }
  // 6 +- sqrt(12 / 300) = 0.2; weights of points beyond 3 sigma make it a little larger.
  EXPECT_GT(sum, 5.2);
  EXPECT_LT(sum, 7.2);
}

INSTANTIATE_TEST_SUITE_P(PointsAndEdges, PlaceByPictures, testing::Bool());

TEST(PlaceByPicturesOnce, HandEyeThatIsUnknownIsInTheResult) {
  // One picture of a robot without error, corners nearly exact: what the hand-eye's place is
  // unknown by, 0.3 mm in all directions, the part's place is unknown by.
  PartScene scene = part_scene(1, false);
  scene.camera.robot_rad = scene.camera.robot_mm = 0.0;
  scene.camera.covariance.diagonal().tail<3>().setConstant(0.09);
  const auto placed = place_by_pictures(scene.camera, scene.pictures, scene.start, 1e-4);
  ASSERT_TRUE(placed.has_value());
  const Eigen::Matrix3d translation = placed->covariance.bottomRightCorner<3, 3>();
  EXPECT_TRUE(translation.isApprox(0.09 * Eigen::Matrix3d::Identity(), 1e-3)) << translation;
  EXPECT_LT(placed->rotation_sigma_rad(), 1e-5);
}

TEST(PlaceByPicturesOnce, CameraInTheCellAsksNoRobot) {
  PartScene scene = part_scene(2, false);
  const Isometry3d base_from_camera = scene.pictures[0].base_from_flange * scene.camera.hand_eye;
  scene.camera.mounting = Mounting::kEyeToHand;
  scene.camera.hand_eye = base_from_camera;
  scene.pictures.resize(1);
  scene.pictures[0].base_from_flange = some_pose();
  const auto placed = place_by_pictures(scene.camera, scene.pictures, scene.start, 0.2);
  ASSERT_TRUE(placed.has_value());
  EXPECT_LT(six_of(placed->base_from_part.inverse() * scene.base_from_part).norm(), 1e-6);
}

TEST(PlaceByPicturesOnce, LimitsASingleWrongPoint) {
  PartScene scene = part_scene(4, false);
  scene.pictures[1].picture_px[3].x() += 40.0;
  const auto placed = place_by_pictures(scene.camera, scene.pictures, scene.start, 0.2);
  ASSERT_TRUE(placed.has_value());
  EXPECT_LT(six_of(placed->base_from_part.inverse() * scene.base_from_part).tail<3>().norm(), 0.05);
}

TEST(PlaceByPicturesOnce, SaysWhenADirectionIsOpen) {
  // One straight edge leaves the part free along it and about it.
  PartScene scene = part_scene(1, false);
  PartPicture edge;
  edge.base_from_flange = scene.pictures[0].base_from_flange;
  for (int i = 0; i < 20; ++i) {
    const Vector3d point(2.0 * i, 0.0, 0.0);
    const Isometry3d seen =
        camera_from_board(Mounting::kEyeInHand,
                          {.hand_eye = scene.camera.hand_eye, .board = scene.base_from_part},
                          edge.base_from_flange);
    edge.part_mm.push_back(point);
    edge.picture_px.push_back(*project_by_lens(scene.camera.lens, seen * point, nullptr));
    edge.normals.emplace_back(0.0, 1.0);
  }
  const std::vector<PartPicture> pictures = {edge};
  EXPECT_FALSE(place_by_pictures(scene.camera, pictures, scene.base_from_part, 0.2).has_value());
  EXPECT_FALSE(place_by_pictures(scene.camera, {}, scene.start, 0.2).has_value());
  EXPECT_FALSE(place_by_pictures(scene.camera, scene.pictures, scene.start, 0.0).has_value());
  scene.pictures[0].picture_px.pop_back();
  EXPECT_FALSE(place_by_pictures(scene.camera, scene.pictures, scene.start, 0.2).has_value());
}

}  // namespace
}  // namespace glint
