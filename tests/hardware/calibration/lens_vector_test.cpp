// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/lens_vector.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

LensVector test_lens() {
  LensVector lens;
  lens << 1000.0, 1000.0, 600.0, 500.0, -0.1, 0.0, 0.0, 0.001, 0.002;
  return lens;
}

TEST(ProjectByLens, GivesTheHandWorkedPixel) {
  // x = 0.2, y = 0.1, s = 0.05, radial 1 - 0.1 * 0.05 = 0.995.
  // x' = 0.199 + 2 * 0.001 * 0.02 + 0.002 * (0.05 + 0.08) = 0.1993
  // y' = 0.0995 + 0.001 * (0.05 + 0.02) + 2 * 0.002 * 0.02 = 0.09965
  const auto pixel = project_by_lens(test_lens(), {0.4, 0.2, 2.0}, nullptr);
  ASSERT_TRUE(pixel.has_value());
  EXPECT_NEAR(pixel->x(), 799.3, 1e-10);
  EXPECT_NEAR(pixel->y(), 599.65, 1e-10);
}

TEST(ProjectByLens, AgreesWithPinholeCamera) {
  const PinholeCamera camera(intrinsics_from(test_lens(), 1200, 1000));
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(3, Stream::kTest, i);
    const double x = rng.uniform(-0.5, 0.5);
    const Vector3d point(x, rng.uniform(-0.4, 0.4), 1.0);
    const auto own = project_by_lens(test_lens(), 700.0 * point, nullptr);
    const auto other = camera.project(700.0 * point);
    ASSERT_TRUE(own.has_value() && other.has_value());
    EXPECT_LT((*own - *other).norm(), 1e-10);
  }
}

TEST(ProjectByLens, DerivativesAreThoseOfDifferences) {
  const Vector3d point(30.0, -50.0, 200.0);
  LensVector lens = test_lens();
  lens.segment<3>(4) << -0.1, 0.05, 0.02;
  LensDerivatives derivatives;
  ASSERT_TRUE(project_by_lens(lens, point, &derivatives).has_value());
  for (Eigen::Index i = 0; i < 9; ++i) {
    const LensVector step = LensVector::Unit(i) * (i < 4 ? 1e-3 : 1e-5);
    const Vector2d moved = *project_by_lens(lens + step, point, nullptr) -
                           *project_by_lens(lens - step, point, nullptr);
    EXPECT_LT((moved / (2.0 * step[i]) - derivatives.by_lens.col(i)).norm(), 1e-6) << i;
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3d step = 1e-4 * Vector3d::Unit(i);
    const Vector2d moved = *project_by_lens(lens, point + step, nullptr) -
                           *project_by_lens(lens, point - step, nullptr);
    EXPECT_LT((moved / 2e-4 - derivatives.by_point.col(i)).norm(), 1e-6) << i;
  }
}

TEST(ProjectByLens, IsEmptyBehindTheCamera) {
  EXPECT_FALSE(project_by_lens(test_lens(), {0.0, 0.0, -1.0}, nullptr).has_value());
  EXPECT_FALSE(project_by_lens(test_lens(), {0.0, 0.0, 0.0}, nullptr).has_value());
}

TEST(IsPossibleLens, RefusesAFoldWithinThePicture) {
  LensVector lens = test_lens();
  EXPECT_TRUE(is_possible_lens(lens, 1200, 1000));
  lens[4] = -1.0;  // folds where 3 r^2 = 1, at r = 0.58; the picture's corner lies at 0.78
  EXPECT_FALSE(is_possible_lens(lens, 1200, 1000));
  lens[4] = std::nan("");
  EXPECT_FALSE(is_possible_lens(lens, 1200, 1000));
}

TEST(LensVector, AndIntrinsicsAreTheSame) {
  const PinholeIntrinsics intrinsics = intrinsics_from(test_lens(), 1200, 1000);
  EXPECT_EQ(intrinsics.tangential[1], 0.002);
  EXPECT_EQ(lens_vector(intrinsics), test_lens());
}

}  // namespace
}  // namespace glint
