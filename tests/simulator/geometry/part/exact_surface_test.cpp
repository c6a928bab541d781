// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/exact_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// A point of the involute of a circle around x and its outward normal (closed form, not the one
/// the program uses): p = r_b (cos T + T sin T, sin T - T cos T), normal (sin T, -cos T).
SurfaceHit involute_point(double base_mm, double roll_rad) {
  const double c = std::cos(roll_rad);
  const double s = std::sin(roll_rad);
  return {.point_mm = Vector3d(0, base_mm * (c + roll_rad * s), base_mm * (s - roll_rad * c)),
          .normal = Vector3d(0, s, -c)};
}

std::vector<ExactPatch> one_of_each(Rng& rng) {
  std::vector<PatchShape> shapes = {
      PlanePatch{},
      ParaboloidPatch{.radius_along_mm = 800, .radius_across_mm = 80},
      ParaboloidPatch{.radius_along_mm = -300, .radius_across_mm = 120},
      ParaboloidPatch{.radius_across_mm = 60},
      SpherePatch{.radius_mm = 40},
      CylinderPatch{.radius_mm = 25},
      CylinderPatch{.radius_mm = 25, .is_bore = true},
      InvolutePatch{.base_radius_mm = 28, .start_rad = 0.3, .hand = 1.0},
      InvolutePatch{.base_radius_mm = 28, .start_rad = -1.2, .hand = -1.0}};
  std::vector<ExactPatch> patches;
  for (const PatchShape& shape : shapes) {
    patches.push_back({.shape = shape, .scene_from_patch = random_pose(rng)});
  }
  return patches;
}

TEST(ImplicitValue, GradientMatchesCentralDifferences) {
  Rng rng(1, Stream::kTest, 0);
  constexpr double kStepMm = 1e-5;  // rounding 1e-13 / step = 1e-8, curvature ~ step^2
  for (int round = 0; round < 120; ++round) {
    for (const ExactPatch& patch : one_of_each(rng)) {
      const Vector3d local = random_point(rng, 30.0) + Vector3d(0.0, 35.0, 35.0);
      const Vector3d p = patch.scene_from_patch * local;
      Vector3d gradient;
      implicit_value(patch, p, &gradient);
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d step = kStepMm * Vector3d::Unit(axis);
        const double difference =
            (implicit_value(patch, p + step, nullptr) - implicit_value(patch, p - step, nullptr)) /
            (2.0 * kStepMm);
        // Just outside the base circle the involute's second derivative grows without bound.
        ASSERT_NEAR(gradient[axis], difference, 2e-5) << "shape " << patch.shape.index();
      }
    }
  }
}

// z = -100^2 / 1600 - 25^2 / 160 = -6.25 - 3.90625 = -10.15625; slopes 100 / 800, 25 / 80.
TEST(ParaboloidPatchTest, HasTheHandWorkedSagAndSlope) {
  const ExactPatch patch = {.shape =
                                ParaboloidPatch{.radius_along_mm = 800, .radius_across_mm = 80}};
  Vector3d gradient;
  EXPECT_DOUBLE_EQ(implicit_value(patch, {100, 25, -10.15625}, &gradient), 0.0);
  EXPECT_EQ(gradient, Vector3d(0.125, 0.3125, 1.0));
}

// Base radius 10, roll 1 rad: r = 10 sqrt 2, polar angle 1 - pi/4; the gradient has the radial part
// L / r = 10 / (10 sqrt 2) and the same amount backwards along the circle.
TEST(InvolutePatchTest, HasTheHandWorkedGradient) {
  const ExactPatch patch = {.shape = InvolutePatch{.base_radius_mm = 10.0}};
  const double phi = 1.0 - kPi / 4.0;
  const Vector3d e_r(0, std::cos(phi), std::sin(phi));
  const Vector3d e_phi(0, -std::sin(phi), std::cos(phi));
  Vector3d gradient;
  EXPECT_NEAR(implicit_value(patch, 10.0 * std::sqrt(2.0) * e_r, &gradient), 0.0, 1e-14);
  EXPECT_LT((gradient - (e_r - e_phi) / std::sqrt(2.0)).norm(), 1e-14);
}

TEST(InvolutePatchTest, IsTheDistanceAlongTheNormalOfTheClassicalInvolute) {
  Rng rng(2, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const double base_mm = rng.uniform(5.0, 60.0);
    const ExactPatch patch = {.shape = InvolutePatch{.base_radius_mm = base_mm}};
    const SurfaceHit on = involute_point(base_mm, rng.uniform(0.05, 1.0));
    const double offset_mm = rng.uniform(-0.04, 0.04) * base_mm;
    Vector3d gradient;
    const double value_mm = implicit_value(patch, on.point_mm + offset_mm * on.normal, &gradient);
    ASSERT_NEAR(value_mm, offset_mm, 1e-12);
    ASSERT_LT((gradient - on.normal).norm(), 1e-11);
  }
}

TEST(InvolutePatchTest, OfTheOtherHandIsItsMirrorImage) {
  const ExactPatch forward = {.shape =
                                  InvolutePatch{.base_radius_mm = 20, .start_rad = 0.2, .hand = 1}};
  const ExactPatch backward = {
      .shape = InvolutePatch{.base_radius_mm = 20, .start_rad = -0.2, .hand = -1}};
  Vector3d a;
  Vector3d b;
  EXPECT_DOUBLE_EQ(implicit_value(forward, {1, 21, 5}, &a),
                   implicit_value(backward, {1, 21, -5}, &b));
  EXPECT_LT((a - Vector3d(b.x(), b.y(), -b.z())).norm(), 1e-15);
}

/// Nearest crossing of a ray with |p_across| = radius: the root of a quadratic.
double first_root(const Vector3d& o, const Vector3d& d, double radius_mm) {
  const double a = d.squaredNorm();
  const double b = o.dot(d);
  return (-b - std::sqrt(b * b - a * (o.squaredNorm() - radius_mm * radius_mm))) / a;
}

TEST(Polish, FindsTheClosedFormOnSphereCylinderAndPlane) {
  Rng rng(3, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const RigidTransform pose = random_pose(rng);
    const Vector3d origin(rng.uniform(-10, 10), rng.uniform(-10, 10), 400.0);
    const Vector3d direction =
        (Vector3d(rng.uniform(-10, 10), rng.uniform(-10, 10), 10.0) - origin).normalized();
    const Vector3d across(0, 1, 1);
    const std::vector<std::pair<PatchShape, double>> cases = {
        {SpherePatch{.radius_mm = 40}, first_root(origin, direction, 40)},
        {CylinderPatch{.radius_mm = 25},
         first_root(origin.cwiseProduct(across), direction.cwiseProduct(across), 25)},
        {PlanePatch{}, -origin.z() / direction.z()}};
    const Ray ray = {.origin_mm = pose * origin, .direction = pose.rotation * direction};
    for (const auto& [shape, t_mm] : cases) {
      const auto hit = polish(
          {.shape = shape, .scene_from_patch = pose}, ray, t_mm + rng.uniform(-0.01, 0.01), 0.1);
      ASSERT_TRUE(hit.has_value());
      ASSERT_NEAR(hit->t_mm, t_mm, 1e-10);
      ASSERT_LT((hit->point_mm - (ray.origin_mm + t_mm * ray.direction)).norm(), 1e-10);
      ASSERT_NEAR(hit->normal.norm(), 1.0, 1e-14);
      ASSERT_LT(hit->normal.dot(ray.direction), 0.0);
    }
  }
}

TEST(Polish, FindsThePointOfAnInvoluteItWasAimedAt) {
  Rng rng(4, Stream::kTest, 0);
  int polished = 0;
  for (int i = 0; i < 1500; ++i) {
    const SurfaceHit on = involute_point(28.0, rng.uniform(0.02, 0.6));
    const Vector3d direction = random_direction(rng);
    if (std::abs(direction.dot(on.normal)) < 0.2) {
      continue;
    }
    const Ray ray = {.origin_mm = on.point_mm - 100.0 * direction, .direction = direction};
    const auto hit = polish({.shape = InvolutePatch{.base_radius_mm = 28.0}}, ray, 100.003, 0.05);
    ASSERT_TRUE(hit.has_value());
    ASSERT_NEAR(hit->t_mm, 100.0, 1e-10);
    ASSERT_LT((hit->normal - on.normal).norm(), 1e-8);
    ++polished;
  }
  EXPECT_GE(polished, 1000);
}

TEST(Polish, LeavesTheHitOfAParaboloidOnTheSurface) {
  Rng rng(5, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const ExactPatch patch = {
        .shape = ParaboloidPatch{.radius_along_mm = 800, .radius_across_mm = -80},
        .scene_from_patch = random_pose(rng)};
    const double x = rng.uniform(-100, 100);
    const double y = rng.uniform(-25, 25);
    const Vector3d on(x, y, -x * x / 1600.0 + y * y / 160.0);
    const Vector3d from(rng.uniform(-50, 50), rng.uniform(-50, 50), 600.0);
    const Ray ray = {.origin_mm = patch.scene_from_patch * from,
                     .direction = patch.scene_from_patch.rotation * (on - from).normalized()};
    const auto hit = polish(patch, ray, (on - from).norm() + rng.uniform(-2e-3, 2e-3), 0.05);
    ASSERT_TRUE(hit.has_value());
    ASSERT_NEAR(implicit_value(patch, hit->point_mm, nullptr), 0.0, 1e-12);
    ASSERT_NEAR(hit->t_mm, (on - from).norm(), 1e-10);
  }
}

TEST(Polish, GivesUpBeyondTheAllowedMove) {
  const ExactPatch plane = {.shape = PlanePatch{}};
  const Ray ray = {.origin_mm = {0, 0, 10}, .direction = {0, 0, -1}};
  EXPECT_TRUE(polish(plane, ray, 9.9, 0.2).has_value());
  EXPECT_FALSE(polish(plane, ray, 9.7, 0.2).has_value());
}

TEST(Polish, GivesUpOnARayThatNeverMeetsTheSurface) {
  const Ray parallel = {.origin_mm = {0, 0, 10}, .direction = {1, 0, 0}};
  EXPECT_FALSE(polish({.shape = PlanePatch{}}, parallel, 5.0, 1e6).has_value());
  const Ray beside = {.origin_mm = {0, 40.001, 100}, .direction = {0, 0, -1}};
  EXPECT_FALSE(polish({.shape = SpherePatch{.radius_mm = 40}}, beside, 99.9, 1.0).has_value());
}

}  // namespace
}  // namespace glint
