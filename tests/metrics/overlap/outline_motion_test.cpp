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

/// Two sides of a part that leaves a picture to the right and below, from the corner in its middle
/// on; edges are located with noise along their normals.
std::vector<EdgeOffset> corner_offsets(double size_px, const Vector2d& shift_px, Rng& rng) {
  constexpr double kNoise = 0.1;
  const double middle = 0.5 * size_px;
  std::vector<EdgeOffset> offsets;
  double along = 0.5;
  while (along < middle) {
    for (const bool is_upright : {false, true}) {
      const Vector2d normal = is_upright ? Vector2d(-1.0, 0.0) : Vector2d(0.0, -1.0);
      const Vector2d from_corner = is_upright ? Vector2d(0.0, along) : Vector2d(along, 0.0);
      const double own = kNoise * rng.normal();
      offsets.push_back({.at_px = Vector2d(middle, middle) + from_corner + own * normal,
                         .normal = normal,
                         .offset_px = normal.dot(shift_px) - own + kNoise * rng.normal()});
    }
    along += 1.0;
  }
  return offsets;
}

// Noise is all that differs across one side: it is no scale, by which the rest of the part would
// lie elsewhere.
TEST(OutlineMotion, HasNoScaleOfACorner) {
  const Vector2d shift_px(2.0, 2.0);
  for (const double size_px : {120.0, 600.0}) {
    const Vector2d far_px(0.85 * size_px, 0.85 * size_px);
    for (std::uint64_t i = 0; i < 20; ++i) {
      Rng rng(2, Stream::kTest, i);
      const OutlineMotion found = fit_outline_motion(corner_offsets(size_px, shift_px, rng), 0.5);
      ASSERT_LT((found.moved(far_px) - far_px - shift_px).norm(), 0.3) << size_px << " " << i;
    }
  }
}

/// Straight sides that run along `along`, 200 px long and 60 px apart, of a part moved by a shift.
/// Normals scatter as those of a mask's steps do, and a real edge is looked for along them.
std::vector<EdgeOffset> side_offsets(const Vector2d& along,
                                     int sides,
                                     const Vector2d& shift_px,
                                     Rng& rng) {
  const Vector2d across(-along.y(), along.x());
  std::vector<EdgeOffset> offsets;
  for (int side = 0; side < sides; ++side) {
    for (int i = 0; i < 200; ++i) {
      const double askew = 0.066 * rng.normal();
      const Vector2d outwards = (side == 0 ? -1.0 : 1.0) * across;
      const Vector2d normal = std::cos(askew) * outwards + std::sin(askew) * along;
      offsets.push_back(
          {.at_px = Vector2d(100.0, 80.0) + (i - 99.5) * along + 60.0 * side * across,
           .normal = normal,
           .offset_px = outwards.dot(shift_px) / std::cos(askew) + 0.1 * rng.normal()});
    }
  }
  return offsets;
}

// Nothing shows how far a straight side was moved along itself: neither the noise of its edges nor
// the scatter of its normals does.
TEST(OutlineMotion, HasNoShiftAlongStraightSides) {
  const Vector2d shift_px(3.0, 2.0);
  for (const double turn : {0.0, 0.07, 0.8}) {
    const Vector2d along(std::cos(turn), std::sin(turn));
    const Vector2d across(-along.y(), along.x());
    for (const int sides : {1, 2}) {
      for (const bool is_shift_only : {false, true}) {
        Rng rng(3, Stream::kTest, static_cast<std::uint64_t>(sides));
        const OutlineMotion found =
            fit_outline_motion(side_offsets(along, sides, shift_px, rng), 0.5, is_shift_only);
        EXPECT_FALSE(found.is_shift_told());
        EXPECT_GT(found.untold.dot(along), 0.999) << turn << " " << sides;
        EXPECT_LT(std::abs(found.shift_px.dot(found.untold)), 1e-9) << turn << " " << sides;
        EXPECT_NEAR(found.shift_px.dot(across), shift_px.dot(across), 0.1) << turn << " " << sides;
      }
    }
  }
}

EdgeOffset shifted_edge(const Vector2d& at, const Vector2d& normal, const Vector2d& shift_px) {
  return {.at_px = at, .normal = normal, .offset_px = normal.dot(shift_px)};
}

// The mean square of an arc's normals along its chord is (1 - sin a / a) / 2: 0.0106 of 20.5
// degrees, 0.0057 of 15.
TEST(OutlineMotion, HasTheShiftAlongAnArcFromTwentyDegreesOn) {
  for (const double arc_deg : {15.0, 20.5, 60.0}) {
    std::vector<EdgeOffset> offsets;
    for (int i = 0; i < 300; ++i) {
      const double angle = arc_deg * kRadPerDeg * ((i + 0.5) / 300.0 - 0.5);
      const Vector2d normal(std::sin(angle), -std::cos(angle));
      offsets.push_back(shifted_edge(600.0 * normal, normal, {1.0, 0.5}));
    }
    const OutlineMotion found = fit_outline_motion(offsets, 0.5);
    EXPECT_EQ(found.is_shift_told(), arc_deg > 20.0) << arc_deg;
    EXPECT_NEAR(found.shift_px.x(), arc_deg > 20.0 ? 1.0 : 0.0, 0.01) << arc_deg;
    EXPECT_NEAR(found.shift_px.y(), 0.5, 0.01) << arc_deg;
  }
}

// A bar of 1000 x 9 px: its ends are 18 of 2018 edges, and tell how far it was moved along.
TEST(OutlineMotion, HasTheShiftAlongABarByItsEnds) {
  const Vector2d shift_px(0.8, -0.6);
  std::vector<EdgeOffset> offsets;
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < 1000; ++i) {
      offsets.push_back(shifted_edge({i + 0.5, 4.5 * side}, {0.0, side}, shift_px));
    }
    for (int i = 0; i < 9; ++i) {
      offsets.push_back(shifted_edge({500.0 + 500.0 * side, i - 4.0}, {side, 0.0}, shift_px));
    }
  }
  const OutlineMotion found = fit_outline_motion(offsets, 0.5);
  EXPECT_TRUE(found.is_shift_told());
  EXPECT_NEAR(found.shift_px.x(), 0.8, 0.05);
  EXPECT_NEAR(found.shift_px.y(), -0.6, 0.05);
}

// No turn of a circle, but its scale and its stretch.
TEST(OutlineMotion, HasTheScaleOfACircle) {
  OutlineMotion motion = {.shift_px = {1.0, 0.5}};
  motion.linear << 0.03, 0.0, 0.0, -0.01;
  std::vector<EdgeOffset> offsets;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2.0 * kPi * i / 400.0;
    const Vector2d normal(std::cos(angle), std::sin(angle));
    offsets.push_back({.at_px = 100.0 * normal,
                       .normal = normal,
                       .offset_px = normal.dot(motion.moved(100.0 * normal) - 100.0 * normal)});
  }
  EXPECT_LT((fit_outline_motion(offsets, 0.3).linear - motion.linear).norm(), 1e-4);
}

}  // namespace
}  // namespace glint
