// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/outline_motion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;

/// Points of a circle of 100 px about (150, 120), moved; a share of them has been taken for others.
std::vector<EdgeOffset> circle_offsets(const OutlineMotion& motion, double wrong, Rng& rng) {
  std::vector<EdgeOffset> offsets;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2.0 * kPi * i / 400.0;
    // An ellipse: of a circle no turn can be told.
    const Vector2d at(150.0 + 100.0 * std::cos(angle), 120.0 + 60.0 * std::sin(angle));
    const Vector2d normal = Vector2d(std::cos(angle) / 100.0, std::sin(angle) / 60.0).normalized();
    const bool is_wrong = i < wrong * 400.0;
    offsets.push_back({.at_px = at,
                       .normal = normal,
                       .offset_px = is_wrong
                                        ? -12.0 - 8.0 * rng.uniform()
                                        : normal.dot(motion.moved(at) - at) + 0.1 * rng.normal()});
  }
  return offsets;
}

TEST(OutlineMotion, IsWhatMostEdgesAgreeUpon) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(1, Stream::kTest, i);
    OutlineMotion motion = {.middle_px = {150.0, 120.0},
                            .shift_px = {2.0 * rng.normal(), 2.0 * rng.normal()}};
    motion.linear << 0.01 * rng.normal(), -0.01, 0.01, 0.01 * rng.normal();
    const OutlineMotion found =
        fit_outline_motion(circle_offsets(motion, 0.15 * rng.uniform(), rng), 0.3);
    // One side wrong: beyond a fifth of all edges a stretch can follow it.
    // Along the normals, where no edge was taken for another: of 300 edges with a deviation of
    // 0.1 px some 0.02 px.
    ASSERT_NEAR((found.moved({50.0, 120.0}) - motion.moved({50.0, 120.0})).x(), 0.0, 0.08) << i;
    ASSERT_NEAR((found.moved({150.0, 60.0}) - motion.moved({150.0, 60.0})).y(), 0.0, 0.08) << i;
  }
}

// Four of five edges agree upon nothing: then it is not the motion that is found.
TEST(OutlineMotion, NeedsAMajority) {
  Rng rng(1, Stream::kTest, 0);
  const OutlineMotion motion = {.middle_px = {150.0, 120.0}, .shift_px = {3.0, 0.0}};
  const OutlineMotion found = fit_outline_motion(circle_offsets(motion, 0.8, rng), 0.3);
  EXPECT_GT((found.moved({50.0, 120.0}) - motion.moved({50.0, 120.0})).norm(), 1.0);
}

TEST(OutlineMotion, IsAShiftWhereThatIsAsked) {
  Rng rng(1, Stream::kTest, 0);
  OutlineMotion motion = {.middle_px = {150.0, 120.0}, .shift_px = {1.0, -2.0}};
  const auto offsets = circle_offsets(motion, 0.0, rng);
  const OutlineMotion found = fit_outline_motion(offsets, 0.3, true);
  EXPECT_TRUE(found.linear.isZero());
  EXPECT_NEAR(found.shift_px.x(), 1.0, 0.03);
  EXPECT_NEAR(found.shift_px.y(), -2.0, 0.03);
  EXPECT_TRUE(fit_outline_motion({}, 0.3).shift_px.isZero());
}

}  // namespace
}  // namespace glint
