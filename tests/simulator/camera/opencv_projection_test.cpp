// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "core/rng.h"
#include "simulator/camera/camera_settings.h"

namespace glint {
namespace {

TEST(PinholeCamera, AgreesWithOpenCvProjectPoints) {
  const PinholeIntrinsics in = {.width_px = 2448,
                                .height_px = 2048,
                                .focal_px = {4637.0, 4640.0},
                                .center_px = {1230.5, 1017.0},
                                .radial = {-0.12, 0.08, -0.01},
                                .tangential = {3e-4, -2e-4}};
  const PinholeCamera camera(in);
  const RigidTransform pose = camera_from_world({.position_mm = {40.0, -30.0, 500.0},
                                                 .direction = {-0.1, 0.05, -1.0},
                                                 .up = {0.2, 1.0, 0.1}});
  std::vector<cv::Point3d> points;
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    points.emplace_back(rng.uniform(-100, 100), rng.uniform(-80, 80), rng.uniform(-20, 20));
  }
  cv::Mat rotation(3, 3, CV_64F);
  cv::Mat translation(3, 1, CV_64F);
  for (int r = 0; r < 3; ++r) {
    translation.at<double>(r) = pose.translation_mm[r];
    for (int c = 0; c < 3; ++c) {
      rotation.at<double>(r, c) = pose.rotation(r, c);
    }
  }
  cv::Mat rotation_vector;
  cv::Rodrigues(rotation, rotation_vector);
  const Eigen::Vector2d center = opencv_from_pixel(in.center_px);
  const cv::Matx33d matrix(in.focal_px.x(), 0, center.x(), 0, in.focal_px.y(), center.y(), 0, 0, 1);
  const std::vector<double> distortion = {
      in.radial[0], in.radial[1], in.tangential[0], in.tangential[1], in.radial[2]};
  std::vector<cv::Point2d> expected;
  cv::projectPoints(points, rotation_vector, translation, matrix, distortion, expected);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel =
        camera.project(pose * Eigen::Vector3d(points[i].x, points[i].y, points[i].z));
    ASSERT_TRUE(pixel.has_value());
    const Eigen::Vector2d ours = opencv_from_pixel(*pixel);
    EXPECT_NEAR(ours.x(), expected[i].x, 1e-9);
    EXPECT_NEAR(ours.y(), expected[i].y, 1e-9);
  }
}

// OpenCV's forward model on the ray that Glint made for a pixel must come back to that pixel.
TEST(PinholeCamera, RaysOfRandomLensesProjectBackThroughOpenCv) {
  Rng rng(2, Stream::kTest, 0);
  double worst_px = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const PinholeIntrinsics in = {
        .width_px = 2448,
        .height_px = 2050,
        .focal_px = {rng.uniform(3000, 6000), rng.uniform(3000, 6000)},
        .center_px = {rng.uniform(1150, 1300), rng.uniform(950, 1100)},
        .radial = {rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3)},
        .tangential = {rng.uniform(-5e-3, 5e-3), rng.uniform(-5e-3, 5e-3)}};
    const PinholeCamera camera(in);
    const Eigen::Vector2d pixel_px(rng.uniform(0, 2448), rng.uniform(0, 2050));
    const auto ray = camera.ray_through(pixel_px);
    ASSERT_TRUE(ray.has_value());
    const Eigen::Vector2d center = opencv_from_pixel(in.center_px);
    const cv::Matx33d matrix(
        in.focal_px.x(), 0, center.x(), 0, in.focal_px.y(), center.y(), 0, 0, 1);
    const std::vector<double> distortion = {
        in.radial[0], in.radial[1], in.tangential[0], in.tangential[1], in.radial[2]};
    const std::vector<cv::Point3d> points = {{ray->x(), ray->y(), ray->z()}};
    std::vector<cv::Point2d> seen;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix, distortion, seen);
    const Eigen::Vector2d wanted = opencv_from_pixel(pixel_px);
    worst_px = std::max(worst_px, std::hypot(seen[0].x - wanted.x(), seen[0].y - wanted.y()));
  }
  EXPECT_LT(worst_px, 1e-8);
}

}  // namespace
}  // namespace glint
