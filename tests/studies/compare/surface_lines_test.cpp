// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/surface_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "core/cpu_clock.h"

namespace glint {
namespace {

/// Rings of one width around the middle, the outermost first.
NamedSurfaces rings(int count, double outer_px, int size_px) {
  NamedSurfaces surfaces = {.labels = Image<int>(size_px, size_px)};
  surfaces.names.assign(static_cast<std::size_t>(count), "plane");
  for (int y = 0; y < size_px; ++y) {
    for (int x = 0; x < size_px; ++x) {
      const double radius = std::hypot(x + 0.5 - 0.5 * size_px, y + 0.5 - 0.5 * size_px);
      surfaces.labels(x, y) =
          radius < outer_px ? count - static_cast<int>(radius * count / outer_px) : 0;
    }
  }
  return surfaces;
}

double seconds_for(const NamedSurfaces& surfaces) {
  return min_cpu_s(
      5, 0.0, [&] { EXPECT_EQ(lines_between(surfaces).size(), surfaces.names.size() - 1); });
}

// 30 rings of 10 px: each meets the next one along its inner circle, and the radii are right.
TEST(SurfaceLines, AreRoundBetweenRings) {
  const std::vector<SurfaceLine> lines = lines_between(rings(30, 300.0, 620));
  ASSERT_EQ(lines.size(), 29U);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int from = static_cast<int>(i) + 1;
    EXPECT_EQ(lines[i].from, from);
    EXPECT_EQ(lines[i].to, from + 1);
    for (const BoundaryPoint& point : lines[i].line.points) {
      const Eigen::Vector2d away = point.at_px - Eigen::Vector2d(310.0, 310.0);
      ASSERT_NEAR(away.norm(), 300.0 - 10.0 * from, 0.8);
      ASSERT_LT(point.normal.dot(away), 0.0);
    }
  }
}

// A surface in two parts, the second of which begins within a block of pixels: it meets its
// neighbour there.
TEST(SurfaceLines, AreFoundAtEveryPartOfASurface) {
  NamedSurfaces surfaces = {.labels = Image<int>(64, 40), .names = {"one", "other"}};
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 64; ++x) {
      surfaces.labels(x, y) = x >= 24 ? 2 : x < 8 || x >= 18 ? 1 : 0;
    }
  }
  const std::vector<SurfaceLine> lines = lines_between(surfaces);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].from, 1);
  EXPECT_EQ(lines[0].to, 2);
  EXPECT_NEAR(lines[0].line.points[lines[0].line.points.size() / 2].at_px.x(), 24.0, 0.1);
}

// Surfaces around each other cost what their picture does, not what it does for each of them.
TEST(SurfaceLines, CostLittleMoreForManyRings) {
  const double few = seconds_for(rings(5, 800.0, 1620));
  const double many = seconds_for(rings(80, 800.0, 1620));
  RecordProperty("ratio", std::to_string(many / few));
  std::printf("80 rings cost %.2f times what 5 cost\n", many / few);
  EXPECT_LT(many, 8.0 * few);
}

}  // namespace
}  // namespace glint
