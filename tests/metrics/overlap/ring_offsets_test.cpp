// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/ring_offsets.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;

const Vector2d kCentre(300.0, 250.0);

/// Edges with random places and normals that moved by `motion(at)`, with noise.
template <class Motion>
std::vector<EdgeOffset> edges_moved_by(const Motion& motion, double noise_px, std::uint64_t index) {
  Rng rng(11, Stream::kTest, index);
  std::vector<EdgeOffset> edges;
  for (int i = 0; i < 2000; ++i) {
    const double angle = rng.uniform(0.0, 2.0 * kPi);
    EdgeOffset edge = {.at_px = {rng.uniform(0.0, 600.0), rng.uniform(0.0, 500.0)},
                       .normal = {std::cos(angle), std::sin(angle)}};
    edge.offset_px =
        edge.normal.dot(motion(Vector2d(edge.at_px - kCentre))) + noise_px * rng.normal();
    edges.push_back(edge);
  }
  return edges;
}

// A picture 0.2 % too large and turned by 1 mrad, and shifted: 2 px and 1 px over 1000 px of
// radius.
TEST(RingOffsets, TellsScaleAndTurnFromAShift) {
  const auto edges = edges_moved_by(
      [](const Vector2d& from) -> Vector2d {
        return Vector2d(0.7, -0.4) + 0.002 * from + 0.001 * Vector2d(-from.y(), from.x());
      },
      0.0,
      0);
  const RingOffsets rings = ring_offsets(edges, kCentre, 5);
  ASSERT_TRUE(rings.radial_slope && rings.tangential_slope);
  EXPECT_NEAR(rings.radial_slope->value, 2.0, 1e-4);
  EXPECT_NEAR(rings.tangential_slope->value, 1.0, 1e-4);
}

TEST(RingOffsets, ShowsTheMotionInEachRing) {
  const auto edges =
      edges_moved_by([](const Vector2d& from) { return Vector2d(0.003 * from); }, 0.0, 1);
  const RingOffsets rings = ring_offsets(edges, kCentre, 4);
  ASSERT_EQ(rings.rings.size(), 4U);
  for (const OffsetRing& ring : rings.rings) {
    ASSERT_TRUE(ring.has_radial && ring.has_tangential);
    EXPECT_GT(ring.radial_px, 0.003 * ring.inner_px);
    EXPECT_LT(ring.radial_px, 0.003 * ring.outer_px);
    EXPECT_NEAR(ring.tangential_px, 0.0, 0.05);
  }
}

// 95 of 100 intervals hold the truth; those of another slope, 0.5 px away, hardly any.
TEST(RingOffsets, HasIntervalsThatHold) {
  int held = 0;
  int held_wrong = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const auto edges =
        edges_moved_by([](const Vector2d& from) { return Vector2d(0.001 * from); }, 0.3, i);
    const Estimate slope = ring_offsets(edges, kCentre).radial_slope.value();
    held += slope.low <= 1.0 && 1.0 <= slope.high ? 1 : 0;
    held_wrong += slope.low <= 1.5 && 1.5 <= slope.high ? 1 : 0;
  }
  EXPECT_GE(held, 178);
  EXPECT_LE(held_wrong, 40);
}

TEST(RingOffsets, HasNoSlopesOfAFewEdges) {
  const auto edges = edges_moved_by([](const Vector2d& from) { return Vector2d(from); }, 0.0, 0);
  EXPECT_FALSE(ring_offsets(std::span(edges).first(20), kCentre).radial_slope);
  EXPECT_TRUE(ring_offsets({}, kCentre).rings.empty());
}

// Edges that all point along the radius say nothing about turns.
TEST(RingOffsets, KnowsWhatItsEdgesCannotTell) {
  std::vector<EdgeOffset> edges;
  for (int i = 0; i < 100; ++i) {
    const Vector2d out(std::cos(0.06 * i), std::sin(0.06 * i));
    edges.push_back({.at_px = kCentre + 100.0 * out, .normal = out, .offset_px = 0.5});
  }
  const OffsetRing ring = ring_offsets(edges, kCentre, 1).rings.front();
  EXPECT_TRUE(ring.has_radial);
  EXPECT_NEAR(ring.radial_px, 0.5, 1e-9);
  EXPECT_FALSE(ring.has_tangential);
}

/// Edges of a disc around `middle` in both pictures: the noise of one is in an edge's radius and,
/// negated, in its offset.
std::vector<EdgeOffset> edges_of_disc(double radius_px, const Vector2d& middle, double growth_px) {
  constexpr double kNoise_px = 0.02;
  Rng rng(12, Stream::kTest, 0);
  std::vector<EdgeOffset> edges;
  for (int i = 0; i < 1000; ++i) {
    const double angle = 2.0 * kPi * i / 1000.0;
    const Vector2d out(std::cos(angle), std::sin(angle));
    const double noise_px = kNoise_px * rng.normal();
    edges.push_back({.at_px = middle + (radius_px + noise_px) * out,
                     .normal = out,
                     .offset_px = growth_px - noise_px + kNoise_px * rng.normal()});
  }
  return edges;
}

// One radius tells no slope, whether the disc lies in the middle, grows, or lies 20 px beside it:
// r = 120 + 20 cos(angle) then is what a shift along x does, but for some 2 px.
TEST(RingOffsets, HasNoSlopesOfARoundPart) {
  for (const double growth_px : {0.0, 0.5}) {
    for (const double beside_px : {0.0, 20.0}) {
      const auto edges = edges_of_disc(120.0, kCentre + Vector2d(beside_px, 0.0), growth_px);
      const RingOffsets rings = ring_offsets(edges, kCentre);
      EXPECT_FALSE(rings.radial_slope) << growth_px << " " << beside_px;
      EXPECT_FALSE(rings.tangential_slope) << growth_px << " " << beside_px;
    }
  }
}

// With its bore, 40 px smaller, it tells a scale of 0.2 %, and that it is no turn stays untold.
TEST(RingOffsets, HasTheRadialSlopeOfARing) {
  std::vector<EdgeOffset> edges = edges_of_disc(120.0, kCentre, 0.24);
  const std::vector<EdgeOffset> bore = edges_of_disc(80.0, kCentre, 0.16);
  edges.insert(edges.end(), bore.begin(), bore.end());
  const RingOffsets rings = ring_offsets(edges, kCentre);
  ASSERT_TRUE(rings.radial_slope);
  EXPECT_NEAR(rings.radial_slope->value, 2.0, 0.1);
  EXPECT_FALSE(rings.tangential_slope);
}

}  // namespace
}  // namespace glint
