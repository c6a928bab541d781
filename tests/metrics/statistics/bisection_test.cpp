// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/bisection.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

TEST(SmallestDetectable, FindsWhereTheFigureReachesTheTarget) {
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const double power = rng.uniform(0.3, 3.0);
    const double where = rng.uniform(0.02, 50.0);
    const auto found = smallest_detectable(
        [&](double size) { return 3.0 * std::pow(size / where, power); }, 0.01, 100.0, 3.0);
    ASSERT_EQ(found.result, Detectable::kFound);
    EXPECT_GE(found.size, where * (1.0 - 1e-12));
    EXPECT_LE(found.size, where * 1.0101);
    EXPECT_GE(found.statistic, 3.0);
  }
}

TEST(SmallestDetectable, OfAStepIsTheStep) {
  const auto found =
      smallest_detectable([](double size) { return size < 2.0 ? 0.0 : 1.0; }, 1.0, 8.0, 0.9);
  EXPECT_EQ(found.result, Detectable::kFound);
  EXPECT_GE(found.size, 2.0);
  EXPECT_LT(found.size, 2.021);
}

TEST(SmallestDetectable, ReachesATargetThatIsNeverExceeded) {
  const auto step = [](double size) { return size >= 3.0 ? 1.0 : 0.0; };
  const SmallestDetectable found = smallest_detectable(step, 1.0, 10.0, 1.0);
  EXPECT_EQ(found.result, Detectable::kFound);
  EXPECT_NEAR(found.size, 3.0, 0.03);
}

TEST(SmallestDetectable, SaysWhenAllOrNothingIsFound) {
  const auto rising = [](double size) { return size; };
  const auto already = smallest_detectable(rising, 4.0, 8.0, 3.0);
  EXPECT_EQ(already.result, Detectable::kAlready);
  EXPECT_EQ(already.size, 4.0);
  const auto never = smallest_detectable(rising, 0.5, 2.0, 3.0);
  EXPECT_EQ(never.result, Detectable::kNever);
  EXPECT_EQ(never.size, 2.0);
  EXPECT_EQ(never.statistic, 2.0);
  const auto no_number = smallest_detectable([](double) { return std::nan(""); }, 0.5, 2.0, 3.0);
  EXPECT_EQ(no_number.result, Detectable::kNever);
}

TEST(SmallestDetectable, StopsAfterTheAllowedFigures) {
  int calls = 0;
  const auto found = smallest_detectable(
      [&](double size) {
        ++calls;
        return size;
      },
      1e-6,
      1e6,
      1.0,
      {.relative_step = 1e-15, .max_calls = 12});
  EXPECT_EQ(calls, 12);
  EXPECT_EQ(found.result, Detectable::kFound);
}

}  // namespace
}  // namespace glint
