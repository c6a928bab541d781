// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/distortion.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/LU>

#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"
#include "simulator/camera/pinhole_camera.h"

namespace glint {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Distortion random_distortion(Rng& rng) {
  return {.radial = {rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)},
          .tangential = {rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05)}};
}

/// 12 mm lens on 2448 x 2050 pixels of 3.45 um.
PinholeIntrinsics twelve_mm(const Distortion& distortion) {
  return {.width_px = 2448,
          .height_px = 2050,
          .focal_px = {3788.0, 3788.0},
          .center_px = {1224.0, 1025.0},
          .radial = distortion.radial,
          .tangential = distortion.tangential};
}

// d/dr of r + k1 r^3 is 1 + 3 k1 r^2, zero at r^2 = -1 / (3 k1).
TEST(FoldRadius, OfBarrelDistortionIsTheClosedForm) {
  for (const double k1 : {-1e-4, -0.1, -0.3, -8.0, -500.0}) {
    const double expected = std::sqrt(-1.0 / (3.0 * k1));
    EXPECT_NEAR(radial_fold_radius({k1, 0, 0}), expected, 1e-14 * expected);
    EXPECT_NEAR(fold_radius({.radial = {k1, 0, 0}}), expected, 1e-14 * expected);
  }
}

// 1 + 3 k1 s + 5 k2 s^2 with k1 = -1, k2 = 0.4: 1 - 3 s + 2 s^2 = (1 - s)(1 - 2 s), first at 1/2.
// With k1 = -2/3, k2 = 1/5 it is (1 - s)^2: the image stops at r = 1 without turning back.
TEST(FoldRadius, IsTheFirstOfSeveralRoots) {
  EXPECT_NEAR(radial_fold_radius({-1.0, 0.4, 0.0}), std::sqrt(0.5), 1e-14);
  EXPECT_NEAR(radial_fold_radius({-2.0 / 3.0 - 1e-12, 0.2, 0.0}), 1.0, 1e-5);
  EXPECT_TRUE(std::isinf(radial_fold_radius({-2.0 / 3.0 + 1e-9, 0.2, 0.0})));
}

// (1 - s)(1 - 2 s)(1 - 4 s) = 1 - 7 s + 14 s^2 - 8 s^3: k1 = -7/3, k2 = 14/5, k3 = -8/7.
TEST(FoldRadius, OfACubicIsItsSmallestRoot) {
  EXPECT_NEAR(radial_fold_radius({-7.0 / 3.0, 2.8, -8.0 / 7.0}), 0.5, 1e-14);
}

TEST(FoldRadius, IsInfiniteWhereDistortionGrowsForEver) {
  EXPECT_TRUE(std::isinf(fold_radius({})));
  EXPECT_TRUE(std::isinf(fold_radius({.radial = {0.1, 0.2, 0.3}})));
  EXPECT_TRUE(std::isinf(radial_fold_radius({-0.12, 0.08, 0.0})));
}

// Tangential only: against t = (p2, p1) the Jacobian is diag(1 - 6 r tau, 1 - 2 r tau), tau = |t|.
TEST(FoldRadius, OfTangentialDistortionIsTheClosedForm) {
  const double tau = std::hypot(0.03, 0.04);
  EXPECT_NEAR(fold_radius({.tangential = {0.03, -0.04}}), 1.0 / (6.0 * tau), 1e-12);
}

TEST(FoldRadius, IsWhereTheSmallestDeterminantOfAllDirectionsVanishes) {
  Rng rng(3, Stream::kTest, 0);
  int folding = 0;
  for (int i = 0; i < 1000; ++i) {
    const Distortion distortion = random_distortion(rng);
    const double radius = fold_radius(distortion);
    if (!std::isfinite(radius)) {
      continue;
    }
    ++folding;
    double inside = 1e9;
    double outside = 1e9;
    for (int step = 0; step < 720; ++step) {
      const double angle = step * kPi / 360.0;
      const Vector2d direction(std::cos(angle), std::sin(angle));
      Matrix2d jacobian;
      for (const double share : {0.25, 0.5, 0.75, 0.9, 0.999}) {
        distort(distortion, share * radius * direction, &jacobian);
        inside = std::min(inside, jacobian.determinant());
      }
      distort(distortion, 1.01 * radius * direction, &jacobian);
      outside = std::min(outside, jacobian.determinant());
    }
    EXPECT_GT(inside, 0.0) << i;
    EXPECT_LT(outside, 0.0) << i;
  }
  EXPECT_GT(folding, 300);
}

TEST(Distort, JacobianIsTheDerivative) {
  Rng rng(4, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Distortion distortion = random_distortion(rng);
    const Vector2d place(rng.uniform(-0.8, 0.8), rng.uniform(-0.8, 0.8));
    Matrix2d jacobian;
    distort(distortion, place, &jacobian);
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d step = 1e-5 * Vector2d::Unit(axis);
      const Vector2d slope = (distort(distortion, place + step, nullptr) -
                              distort(distortion, place - step, nullptr)) /
                             2e-5;
      EXPECT_LT((slope - jacobian.col(axis)).norm(), 1e-8);
    }
  }
}

TEST(BeforeFold, EndsAtTheFold) {
  const Distortion barrel = {.radial = {-0.3, 0, 0}};  // folds at 1.0541
  EXPECT_TRUE(is_before_fold(barrel, {1.05, 0.0}));
  EXPECT_FALSE(is_before_fold(barrel, {0.0, 1.06}));
  EXPECT_FALSE(is_before_fold(barrel, {0.0, 2.5}));
}

// The error users complain of elsewhere is 1e-3 px and more; here the inverse is exact to rounding.
TEST(PinholeCamera, RandomLensesReprojectWithinABillionthOfAPixel) {
  Rng rng(5, Stream::kTest, 0);
  int accepted = 0;
  for (int i = 0; i < 1000; ++i) {
    Distortion distortion = random_distortion(rng);
    distortion.tangential = {rng.uniform(-0.01, 0.01), rng.uniform(-0.01, 0.01)};
    const PinholeCamera camera(twelve_mm(distortion));
    ++accepted;
    const Vector2d pixel_px(rng.uniform(0.0, 2448.0), rng.uniform(0.0, 2050.0));
    const auto ray = camera.ray_through(pixel_px);
    ASSERT_TRUE(ray.has_value());
    const auto again_px = camera.project(146.0 * *ray);
    ASSERT_TRUE(again_px.has_value());
    EXPECT_LT((*again_px - pixel_px).norm(), 1e-9);
  }
  EXPECT_EQ(accepted, 1000);
}

// p2 = 2: folds at x = -1 / 12 = -0.0833, inside the picture, whose edge is at 1224 / 3788 = 0.323.
TEST(PinholeCamera, RejectsTangentialDistortionThatFoldsInsideTheImageAndNamesTheRadius) {
  try {
    const PinholeCamera camera(twelve_mm({.tangential = {0.0, 2.0}}));
    FAIL() << "a folding distortion was accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith("camera.p1"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("0.0833"));
  }
}

// The corner is at hypot(1224, 1025) / 3788 = 0.42145 of distorted radius. Barrel distortion
// reaches at most (2/3) sqrt(-1 / (3 k1)): 0.42145 = 2/3 r, r = 0.63218, k1 = -0.83407.
TEST(PinholeCamera, AcceptsDistortionUpToTheFoldAtTheCornerAndNoFurther) {
  EXPECT_NO_THROW(PinholeCamera(twelve_mm({.radial = {-0.832, 0, 0}})));
  EXPECT_THROW(PinholeCamera(twelve_mm({.radial = {-0.836, 0, 0}})), ConfigError);
}

}  // namespace
}  // namespace glint
