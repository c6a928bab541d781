// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/trapezoid.h"

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

// 10 at speed 2 and acceleration 1: 2 s and 2 of way for each ramp, 6 at speed 2 between: 7 s.
TEST(Trapezoid, MatchesAHandWorkedMotion) {
  const Trapezoid motion(10.0, 2.0, 1.0);
  EXPECT_DOUBLE_EQ(motion.duration_s(), 7.0);
  EXPECT_DOUBLE_EQ(motion.at(1.0), 0.5);
  EXPECT_DOUBLE_EQ(motion.at(3.0), 4.0);
  EXPECT_DOUBLE_EQ(motion.at(6.0), 9.5);
  EXPECT_DOUBLE_EQ(motion.at(8.0), 10.0);
  EXPECT_DOUBLE_EQ(motion.speed_at(-1.0), 0.0);
  EXPECT_DOUBLE_EQ(motion.speed_at(1.5), 1.5);
  EXPECT_DOUBLE_EQ(motion.speed_at(3.0), 2.0);
  EXPECT_DOUBLE_EQ(motion.speed_at(6.5), 0.5);
  EXPECT_DOUBLE_EQ(motion.speed_at(8.0), 0.0);
}

// Too short for the speed: 1 at acceleration 1 takes 1 s up and 1 s down.
TEST(Trapezoid, BecomesATriangleOnShortWays) {
  const Trapezoid motion(1.0, 5.0, 1.0);
  EXPECT_DOUBLE_EQ(motion.duration_s(), 2.0);
  EXPECT_DOUBLE_EQ(motion.at(1.0), 0.5);
}

TEST(Trapezoid, NeverGoesBackAndKeepsItsLimits) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(3, Stream::kTest, i);
    const double speed = rng.uniform(0.01, 3.0);
    const Trapezoid motion(rng.uniform(0.0, 5.0), speed, rng.uniform(0.01, 10.0));
    const double step_s = std::max(motion.duration_s(), 1e-9) / 100.0;
    for (int k = 0; k < 100; ++k) {
      const double way = motion.at((k + 1) * step_s) - motion.at(k * step_s);
      EXPECT_GE(way, 0.0);
      EXPECT_LE(way, speed * step_s * (1.0 + 1e-9));
    }
  }
}

TEST(Trapezoid, ANoWayTakesNoTime) {
  const Trapezoid motion(0.0, 1.0, 1.0);
  EXPECT_EQ(motion.duration_s(), 0.0);
  EXPECT_EQ(motion.at(1.0), 0.0);
}

}  // namespace
}  // namespace glint
