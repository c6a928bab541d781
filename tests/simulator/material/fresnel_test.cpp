// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/fresnel.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/material/quadrature.h"

namespace glint {
namespace {

TEST(GaussLegendre, IntegratesPolynomialsExactly) {
  const Quadrature rule = gauss_legendre(5);
  for (int degree = 0; degree <= 9; ++degree) {
    double sum = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      sum += rule.weights[i] * std::pow(rule.nodes[i], degree);
    }
    EXPECT_NEAR(sum, 1.0 / (degree + 1), 1e-14) << degree;
  }
}

// 0.5 + 0.5 (1 - 0.5)^5 = 0.515625.
TEST(Fresnel, FollowsSchlick) {
  const Fresnel fresnel = schlick_fresnel(Colour::Constant(0.5));
  EXPECT_DOUBLE_EQ(reflectance(fresnel, 0.5)[1], 0.515625);
  EXPECT_DOUBLE_EQ(reflectance(fresnel, 1.0)[1], 0.5);
  EXPECT_DOUBLE_EQ(reflectance(fresnel, 0.0)[1], 1.0);
}

// At Brewster's angle, tan = 1.5, only the part across the plane is reflected: (5/13)^2 / 2.
TEST(Fresnel, OfADielectricMatchesHandWorkedNumbers) {
  EXPECT_NEAR(dielectric_reflectance(1.5, 1.0), 0.04, 1e-15);
  EXPECT_NEAR(dielectric_reflectance(1.5, 1.0 / std::sqrt(3.25)), 25.0 / 338.0, 1e-12);
  EXPECT_NEAR(dielectric_reflectance(1.5, 0.0), 1.0, 1e-15);
}

TEST(Fresnel, OfAConductorWithoutAbsorptionIsADielectrics) {
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const double n = rng.uniform(1.05, 3.0);
    const double cosine = rng.uniform();
    EXPECT_NEAR(conductor_reflectance(n, 0.0, cosine), dielectric_reflectance(n, cosine), 1e-9);
  }
}

// ((2 - 1)^2 + 3^2) / ((2 + 1)^2 + 3^2) = 10 / 18.
TEST(Fresnel, OfAConductorStartsAtItsNormalReflectanceAndEndsAtOne) {
  EXPECT_DOUBLE_EQ(normal_reflectance(2.0, 3.0), 10.0 / 18.0);
  Rng rng(2, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const double n = rng.uniform(0.05, 5.0);
    const double k = rng.uniform(0.0, 15.0);
    EXPECT_NEAR(conductor_reflectance(n, k, 1.0), normal_reflectance(n, k), 1e-12);
    EXPECT_NEAR(conductor_reflectance(n, k, 0.0), 1.0, 1e-12);
    const double between = conductor_reflectance(n, k, rng.uniform());
    EXPECT_GE(between, 0.0);
    EXPECT_LE(between, 1.0 + 1e-12);
  }
}

TEST(Fresnel, HasTheAverageOverAllDirections) {
  for (const Fresnel& fresnel : {schlick_fresnel({0.1, 0.5, 0.9}),
                                 conductor_fresnel({0.2, 2.0, 3.1}, {3.4, 4.0, 3.3}),
                                 constant_fresnel({0.1, 0.2, 0.3})}) {
    constexpr int kSteps = 4000;
    Colour sum = Colour::Zero();
    for (int i = 0; i < kSteps; ++i) {
      const double mu = (i + 0.5) / kSteps;
      sum += 2.0 * mu / kSteps * reflectance(fresnel, mu);
    }
    EXPECT_LT((sum - fresnel.average).abs().maxCoeff(), 1e-5);
  }
}

// ((196 / 255 + 0.055) / 1.055)^2.4 = 0.78069^2.4 = 0.5520; the second seed's colour.
TEST(LinearFromSrgb, MatchesHandWorkedNumbers) {
  EXPECT_NEAR(linear_from_srgb(196), 0.5520, 1e-4);
  EXPECT_NEAR(linear_from_srgb(199), 0.5711, 1e-4);
  EXPECT_DOUBLE_EQ(linear_from_srgb(255), 1.0);
  EXPECT_DOUBLE_EQ(linear_from_srgb(0), 0.0);
  EXPECT_NEAR(linear_from_srgb(10), 10.0 / 255.0 / 12.92, 1e-15);
}

}  // namespace
}  // namespace glint
