// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/rotation.h"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d random_vector(Rng& rng, double size) {
  const double x = rng.normal();
  const double y = rng.normal();
  return size * Vector3d(x, y, rng.normal()).normalized();
}

TEST(RotationOf, QuarterTurnTakesXToY) {
  // A right-handed quarter turn about z.
  const Vector3d turned =
      rotation_of(0.5 * std::numbers::pi * Vector3d::UnitZ()) * Vector3d::UnitX();
  EXPECT_LT((turned - Vector3d::UnitY()).norm(), 1e-15);
}

TEST(RotationOf, IsUndoneByRotationVectorAtAllSizes) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(1, Stream::kTest, i);
    const double size = i % 2 == 0 ? rng.uniform(0.0, 3.14) : std::pow(10.0, rng.uniform(-14, 0));
    const Vector3d vector = random_vector(rng, size);
    const Matrix3d rotation = rotation_of(vector);
    EXPECT_LT((rotation * rotation.transpose() - Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_LT((rotation_vector_rad(rotation) - vector).norm(), 1e-13 + 1e-7 * (size > 3.1));
  }
}

TEST(RightJacobian, IsTheDerivativeOfTheRotation) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(2, Stream::kTest, i);
    const Vector3d vector = random_vector(rng, std::pow(10.0, rng.uniform(-6.0, 0.4)));
    const Vector3d step = random_vector(rng, 1e-5);
    const Vector3d moved =
        rotation_vector_rad(rotation_of(vector - step).transpose() * rotation_of(vector + step));
    // Central differences: an error of the order of the step's square, 1e-10 relative.
    EXPECT_LT((moved - 2.0 * right_jacobian(vector) * step).norm(), 1e-12);
  }
}

TEST(SixOf, UndoesMotionOf) {
  Vector6d six;
  six << 0.1, -0.2, 0.3, 4.0, -5.0, 6.0;
  EXPECT_LT((six_of(motion_of(six)) - six).norm(), 1e-14);
  EXPECT_EQ(motion_of(six).translation(), Vector3d(4.0, -5.0, 6.0));
}

TEST(MeanPose, OfTwoTurnsAboutOneAxisIsHalfWay) {
  // Turns of 0.2 and 0.6 about z: the mean is 0.4.
  std::vector<Eigen::Isometry3d> poses;
  for (const double angle : {0.2, 0.6}) {
    Vector6d six = Vector6d::Zero();
    six[2] = angle;
    six[3] = 10.0 * angle;
    poses.push_back(motion_of(six));
  }
  const Vector6d mean = six_of(mean_pose(poses));
  EXPECT_NEAR(mean[2], 0.4, 1e-15);
  EXPECT_NEAR(mean[3], 4.0, 1e-15);
}

TEST(NearestRotation, OfAMirrorIsARotation) {
  const Matrix3d mirror = Vector3d(1.0, 1.0, -1.0).asDiagonal();
  EXPECT_NEAR(nearest_rotation(mirror).determinant(), 1.0, 1e-12);
}

}  // namespace
}  // namespace glint
