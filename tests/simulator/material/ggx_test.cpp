// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/ggx.h"

#include <Eigen/LU>

#include <gtest/gtest.h>

#include "simulator/material/ggx_albedo.h"
#include "tests/simulator/material/material_cases.h"

namespace glint {
namespace {

using material_cases::random_direction;

// 0.25^2 = 0.0625; aspect = sqrt(1 - 0.9 * 0.7) = 0.608276; 0.102749 and 0.038017.
TEST(AlphaFromRoughness, GivesTheSecondSeedsMetal) {
  const GgxAlpha<double> alpha = alpha_from_roughness(0.25, 0.7);
  EXPECT_NEAR(alpha.x, 0.102749, 1e-6);
  EXPECT_NEAR(alpha.y, 0.038017, 1e-6);
  const GgxAlpha<double> turned = alpha_from_roughness(0.25, -0.7);
  EXPECT_EQ(turned.x, alpha.y);
  EXPECT_EQ(turned.y, alpha.x);
  EXPECT_EQ(alpha_from_roughness(0.0, 0.0).x, 0.001);
}

// At the normal, alpha 0.5: 1 / (pi 0.25) = 1.27324. At tan 0.5 along x: e = 0.8 (1 + 1) = 1.6.
TEST(GgxDistribution, MatchesHandWorkedNumbers) {
  const GgxAlpha<double> alpha = {0.5, 0.5};
  EXPECT_NEAR(ggx_distribution(alpha, {0, 0, 1}), 1.27324, 1e-5);
  const double s = std::sqrt(0.2);
  EXPECT_NEAR(ggx_distribution(alpha, {s, 0, 2 * s}), 1.27324 / 2.56, 1e-5);
}

// All microfacets together cover the surface: the integral of D cos is 1.
TEST(GgxDistribution, CoversTheSurface) {
  for (const GgxAlpha<double>& alpha : {GgxAlpha<double>{0.2, 0.2}, GgxAlpha<double>{1.0, 0.3}}) {
    constexpr int kSteps = 5000;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; j < 64; ++j) {
        const double cosine = (i + 0.5) / kSteps;
        const LocalDirection m = material_cases::direction_at(cosine, kPi / 32.0 * (j + 0.5));
        sum += ggx_distribution(alpha, m) * cosine * kPi / 32.0 / kSteps;
      }
    }
    EXPECT_NEAR(sum, 1.0, 2e-4);
  }
}

TEST(GgxSampleNormal, GivesUnitNormalsThatTheViewerSees) {
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 5000; ++i) {
    const GgxAlpha<double> alpha = {rng.uniform(0.001, 2.0), rng.uniform(0.001, 2.0)};
    const LocalDirection viewer = random_direction(rng);
    const LocalDirection m = ggx_sample_normal(alpha, viewer, rng.uniform(), rng.uniform());
    ASSERT_NEAR(dot(m, m), 1.0, 1e-12);
    ASSERT_GT(m.z, 0.0);
    ASSERT_GE(dot(m, viewer), -1e-12);
  }
}

TEST(GgxWeight, IsValueOverDensity) {
  Rng rng(2, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const GgxAlpha<double> alpha = {rng.uniform(0.01, 2.0), rng.uniform(0.01, 2.0)};
    const LocalDirection viewer = random_direction(rng);
    const LocalDirection light = random_direction(rng);
    const LocalDirection m = half_vector(viewer, light);
    const double value =
        ggx_distribution(alpha, m) * ggx_visibility(alpha, viewer, light) * light.z;
    const double weight = ggx_weight(alpha, viewer, light);
    EXPECT_NEAR(weight, value / ggx_density(alpha, viewer, m), 1e-9 * weight);
    EXPECT_LE(weight, 1.0 + 1e-12);
  }
}

// A kernel in float sees the same surface.
TEST(Ggx, AgreesInFloat) {
  Rng rng(3, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const GgxAlpha<double> alpha = {rng.uniform(0.05, 1.0), rng.uniform(0.05, 1.0)};
    const GgxAlpha<float> narrow = {static_cast<float>(alpha.x), static_cast<float>(alpha.y)};
    const LocalDirection v = random_direction(rng);
    const Local<float> w = {
        static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    const double u1 = rng.uniform();
    const double u2 = rng.uniform(0.0, 0.999);
    const LocalDirection m = ggx_sample_normal(alpha, v, u1, u2);
    const Local<float> n =
        ggx_sample_normal(narrow, w, static_cast<float>(u1), static_cast<float>(u2));
    EXPECT_NEAR(m.x, static_cast<double>(n.x), 2e-5);
    EXPECT_NEAR(m.y, static_cast<double>(n.y), 2e-5);
    const double density = ggx_density(alpha, v, m);
    EXPECT_NEAR(density, static_cast<double>(ggx_density(narrow, w, n)), 2e-3 * density);
  }
}

TEST(GgxAlbedo, FollowsTheIntegralBetweenItsNodes) {
  const Quadrature rule = gauss_legendre(120);
  Rng rng(4, Stream::kTest, 0);
  for (const auto& [x, y] :
       {std::pair(0.02, 0.02), {0.3, 0.3}, {1.0, 1.0}, {0.3, 0.1}, {1.0, 0.316}}) {
    const GgxAlpha<double> alpha = {x, y};
    const GgxAlbedo table(alpha);
    for (int i = 0; i < 40; ++i) {
      const LocalDirection viewer = random_direction(rng);
      EXPECT_NEAR(
          table.at(viewer, 1.0), ggx_single_albedo(alpha, viewer, rule), x == y ? 1e-3 : 3e-3)
          << x << " " << y << " at " << viewer.z;
    }
  }
}

TEST(GgxAlbedo, IsOneForASmoothSurfaceAndAtGrazing) {
  EXPECT_NEAR(GgxAlbedo({0.001, 0.001}).average(1.0), 1.0, 1e-4);
  EXPECT_NEAR(GgxAlbedo({1.0, 1.0}).at({1, 0, 0}, 1.0), 1.0, 1e-9);
}

TEST(FrameAt, IsOrthonormalForAnyTangent) {
  Rng rng(5, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d normal =
        Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
    const Eigen::Vector3d other(rng.normal(), rng.normal(), rng.normal());
    for (const Eigen::Vector3d& tangent :
         {other, Eigen::Vector3d(normal * -3.0), Eigen::Vector3d(0, 0, 0)}) {
      const ShadingFrame frame = frame_at(normal, tangent);
      Eigen::Matrix3d axes;
      axes << frame.tangent, frame.bitangent, frame.normal;
      ASSERT_TRUE((axes.transpose() * axes).isIdentity(1e-12));
      ASSERT_NEAR(axes.determinant(), 1.0, 1e-12);
      const LocalDirection local = frame.to_local(other);
      ASSERT_LT((axes * Eigen::Vector3d(local.x, local.y, local.z) - other).norm(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace glint
