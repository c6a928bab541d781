// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/arc_chain.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/light/tunnel/tunnel.h"

namespace glint {
namespace {

using Eigen::Vector2d;

// A quarter of the unit circle from (1, 0) to (0, 1) turns by 90 degrees: its bulge is the tangent
// of 22.5 degrees, sqrt(2) - 1, and its middle is (sqrt(1/2), sqrt(1/2)).
TEST(Arc, OfAQuarterCircleHasItsRadiusCentreAndMiddle) {
  const Arc arc = {.from_mm = {1.0, 0.0}, .to_mm = {0.0, 1.0}, .bulge = std::sqrt(2.0) - 1.0};
  EXPECT_NEAR(arc.radius_mm(), 1.0, 1e-12);
  EXPECT_NEAR(arc.angle_rad(), 0.5 * kPi, 1e-12);
  EXPECT_NEAR(arc.centre().norm(), 0.0, 1e-12);
  EXPECT_NEAR((arc.highest() - Vector2d::Constant(std::sqrt(0.5))).norm(), 0.0, 1e-12);
}

double distance_mm(const Arc& arc, const Vector2d& point) {
  const Vector2d chord = arc.to_mm - arc.from_mm;
  const double along = chord.dot(point - arc.from_mm) / chord.squaredNorm();
  const double outside = std::max({0.0, -along, along - 1.0}) * chord.norm();
  if (arc.bulge == 0.0) {
    const Vector2d left(-chord.y(), chord.x());
    return std::hypot(left.normalized().dot(point - arc.from_mm), outside);
  }
  return std::abs((point - arc.centre()).norm() - arc.radius_mm());
}

double distance_mm(const std::vector<Arc>& arcs, const Vector2d& point) {
  double least = 1e300;
  for (const Arc& arc : arcs) {
    least = std::min(least, distance_mm(arc, point));
  }
  return least;
}

TEST(ArcsThrough, ASemicircleIsTwoArcsOfItsRadius) {
  std::vector<Vector2d> points;
  for (int i = 0; i <= 400; ++i) {
    const double angle = kPi * i / 400;
    points.emplace_back(80.0 * std::cos(angle), 80.0 * std::sin(angle));
  }
  const std::vector<Arc> arcs = arcs_through(points);
  ASSERT_EQ(arcs.size(), 2U) << "one may not turn by more than 124 degrees";
  for (const Arc& arc : arcs) {
    EXPECT_NEAR(arc.radius_mm(), 80.0, 1e-6);
    EXPECT_GT(arc.bulge, 0.0) << "counterclockwise";
    EXPECT_NEAR(arc.centre().norm(), 0.0, 1e-6);
  }
}

TEST(ArcsThrough, AStraightLineIsOnePieceAndACornerStaysOne) {
  const std::vector<Arc> arcs =
      arcs_through({{0.0, 0.0}, {10.0, 0.0}, {20.0, 0.0}, {20.0, 15.0}, {20.0, 30.0}});
  ASSERT_EQ(arcs.size(), 2U);
  EXPECT_EQ(arcs[0].bulge, 0.0);
  EXPECT_TRUE(std::isinf(arcs[0].radius_mm()));
  EXPECT_EQ(arcs[0].to_mm, Vector2d(20.0, 0.0));
}

TunnelSettings random_tunnel(Rng& rng) {
  const auto between = [&](double low, double high) { return low + (high - low) * rng.uniform(); };
  TunnelSettings settings;
  settings.shape = static_cast<TunnelSettings::Shape>(static_cast<int>(5.0 * rng.uniform()));
  settings.radius_mm = between(20, 300);
  settings.half_width_mm = between(20, 300);
  settings.height_mm = between(20, 300);
  settings.exponent = between(1.5, 8.0);
  settings.distance_mm = between(40, 200);
  settings.opening_rad = between(0.0, 0.3);
  settings.slot_mm = between(5, 20);
  settings.control_mm.assign(static_cast<std::size_t>(4 + 5 * rng.uniform()), 0.0);
  for (double& control : settings.control_mm) {
    control = between(80, 250);
  }
  return settings;
}

// What a workshop builds from the arcs lies on the simulated wall; few arcs do.
TEST(ArcsThrough, FollowAnyWallWithinTheTolerance) {
  Rng rng(5, Stream::kTest, 0);
  std::size_t most = 0;
  for (int round = 0; round < 1000; ++round) {
    const Tunnel tunnel(random_tunnel(rng));
    for (const std::vector<Vector2d>& panel : tunnel.outline(1.0)) {
      const std::vector<Arc> arcs = arcs_through(panel);
      most = std::max(most, arcs.size());
      EXPECT_EQ(arcs.front().from_mm, panel.front());
      EXPECT_EQ(arcs.back().to_mm, panel.back());
      for (std::size_t i = 1; i < arcs.size(); ++i) {
        EXPECT_EQ(arcs[i].from_mm, arcs[i - 1].to_mm);
      }
      for (std::size_t i = 0; i < panel.size(); i += 3) {
        ASSERT_LE(distance_mm(arcs, panel[i]), kArcTolerance_mm + 1e-9) << "round " << round;
      }
    }
  }
  EXPECT_LE(most, 40U);
}

}  // namespace
}  // namespace glint
