// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/pattern.h"

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

// (3, 4): r = 5, c = S(0) = 0, 5 mod 0.7 = 0.1. (0.5, 0): c = S(0.5) = 0.5, sqrt(1 + 0.25) mod 1.
// (0.25, 0): c = 0.0625 * 2.5 = 0.15625, sqrt(0.40625^2 + 0.15625^2) = 0.43526.
TEST(ConcentricValue, MatchesHandWorkedNumbers) {
  EXPECT_NEAR(concentric_value(3, 4, 0.7), 0.1, 1e-12);
  EXPECT_NEAR(concentric_value(0.5, 0, 1.0), 0.118034, 1e-6);
  EXPECT_NEAR(concentric_value(0.25, 0, 1.0), 0.43526, 1e-5);
}

TEST(ConcentricValue, StaysBelowItsDensity) {
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 5000; ++i) {
    const double density = rng.uniform(0.01, 3.0);
    const double v = concentric_value(rng.uniform(-50, 50), rng.uniform(-50, 50), density);
    ASSERT_GE(v, 0.0);
    ASSERT_LT(v, density * (1.0 + 1e-9));
  }
}

TEST(Texel, MultipliesTheColourAsTheSeedDoes) {
  const PatternSettings seed = {.kind = PatternSettings::Kind::kConcentric, .density = 0.7};
  EXPECT_NEAR(texel_at(seed, {3, 4}).colour[0], 0.1, 1e-12);
  EXPECT_EQ(texel_at(seed, {3, 4}).roughness, 1.0);
  PatternSettings half = seed;
  half.colour = 0.5;
  EXPECT_NEAR(texel_at(half, {3, 4}).colour[0], 0.55, 1e-12);
  half.scaled = true;  // 0.1 / 0.7 = 1/7; 1 - 0.5 * 6/7 = 4/7
  EXPECT_NEAR(texel_at(half, {3, 4}).colour[0], 4.0 / 7.0, 1e-12);
  half.unit_mm = 2.0;
  EXPECT_NEAR(texel_at(half, {6, 8}).colour[0], 4.0 / 7.0, 1e-12);
}

// 1 + 0.5 (2/7 - 1) = 0.642857.
TEST(Texel, VariesTheRoughnessWithinItsFactors) {
  const PatternSettings marks = {
      .kind = PatternSettings::Kind::kConcentric, .density = 0.7, .roughness = 0.5};
  EXPECT_NEAR(texel_at(marks, {3, 4}).roughness, 0.642857, 1e-6);
  EXPECT_EQ(roughness_factors(marks).min, 0.5);
  EXPECT_EQ(roughness_factors(marks).max, 1.5);
  Rng rng(2, Stream::kTest, 0);
  for (int i = 0; i < 2000; ++i) {
    const Texel texel = texel_at(marks, {rng.uniform(-50, 50), rng.uniform(-50, 50)});
    ASSERT_GE(texel.roughness, 0.5);
    ASSERT_LE(texel.roughness, 1.5);
    ASSERT_GE(texel.colour[0], 0.0);
    ASSERT_LE(texel.colour[0], 1.0);
  }
}

TEST(Texel, IsOneWithoutAPattern) {
  EXPECT_EQ(texel_at({}, {3, 4}).colour[2], 1.0);
  EXPECT_EQ(texel_at({}, {3, 4}).roughness, 1.0);
}

}  // namespace
}  // namespace glint
