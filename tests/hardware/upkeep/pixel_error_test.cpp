// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/upkeep/pixel_error.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace glint {
namespace {

const Eigen::Vector2i kSize(400, 300);

LensVector pinhole() {
  LensVector lens = LensVector::Zero();
  lens.head<4>() << 4000.0, 4000.0, 200.0, 150.0;
  return lens;
}

TEST(RayErrors, OfAFocalLengthGrowWithTheDistanceFromTheCentre) {
  Eigen::Matrix<double, 9, 9> covariance = Eigen::Matrix<double, 9, 9>::Zero();
  covariance(0, 0) = covariance(1, 1) = 100.0;  // 10 px each
  const std::array<Eigen::Vector2d, 2> pixels = {Eigen::Vector2d(200, 150),
                                                 Eigen::Vector2d(400, 150)};
  const auto errors = ray_errors_px(pinhole(), covariance, kSize, pixels);
  EXPECT_NEAR(errors[0], 0.0, 1e-9);
  // 200 px from the centre: 10 px of 4000 px of focal length are 0.5 px there.
  EXPECT_NEAR(errors[1], 0.5, 0.002);
}

TEST(RayErrors, OfTheCentreAreMadeUpByATurn) {
  Eigen::Matrix<double, 9, 9> covariance = Eigen::Matrix<double, 9, 9>::Zero();
  covariance(2, 2) = 25.0;
  const std::array<Eigen::Vector2d, 2> pixels = {Eigen::Vector2d(200, 150), Eigen::Vector2d(0, 0)};
  const auto errors = ray_errors_px(pinhole(), covariance, kSize, pixels);
  // A turn by 5/4000 shifts all by 5 px, up to (r/f)^2 = 0.4 % of it at the edge.
  EXPECT_LT(errors[0], 0.02);
  EXPECT_LT(errors[1], 0.05);
}

}  // namespace
}  // namespace glint
