// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/surface/micro_relief.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using Eigen::Vector2d;

// Of 40,000 independent Gaussian numbers the mean scatters by 0.005, the variance by 0.007.
TEST(MicroRelief, HasMeanZeroAndVarianceOneAtCrossingsAndBetween) {
  for (const double offset : {0.0, 0.25, 0.5}) {
    Vector2d mean = Vector2d::Zero();
    Vector2d square = Vector2d::Zero();
    double product = 0.0;
    for (int row = 0; row < 200; ++row) {
      for (int column = 0; column < 200; ++column) {
        const Vector2d slope = relief_slope(
            (2 * column + offset) * kReliefLattice_mm, (2 * row - offset) * kReliefLattice_mm, 3);
        mean += slope / 4e4;
        square += slope.cwiseAbs2() / 4e4;
        product += slope.x() * slope.y() / 4e4;
      }
    }
    EXPECT_LT(mean.norm(), 0.03) << offset;
    EXPECT_NEAR(square.x(), 1.0, 0.03) << offset;
    EXPECT_NEAR(square.y(), 1.0, 0.03) << offset;
    EXPECT_NEAR(product, 0.0, 0.02) << offset;
  }
}

// A Gaussian exceeds 2 sigma with probability 0.0455.
TEST(MicroRelief, IsGaussian) {
  Rng rng(71, Stream::kTest, 0);
  int beyond = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector2d slope = relief_slope(rng.uniform(-5, 5), rng.uniform(-5, 5), 0);
    beyond += std::abs(slope.x()) > 2.0 ? 1 : 0;
  }
  EXPECT_NEAR(beyond / 20000.0, 0.0455, 0.006);
}

TEST(MicroRelief, IsContinuousAndDiffersFromStainToStain) {
  Rng rng(72, Stream::kTest, 0);
  int alike = 0;
  for (int i = 0; i < 1000; ++i) {
    const double u_mm = kReliefLattice_mm * std::floor(rng.uniform(-1000, 1000));
    const double v_mm = rng.uniform(-5, 5);
    const double step_mm = 1e-9;
    const Vector2d before = relief_slope(u_mm - step_mm, v_mm, 1);
    EXPECT_LT((before - relief_slope(u_mm + step_mm, v_mm, 1)).norm(), 1e-4);
    alike += (before - relief_slope(u_mm - step_mm, v_mm, 2)).norm() < 0.1 ? 1 : 0;
  }
  EXPECT_LT(alike, 50);
}

}  // namespace
}  // namespace glint
