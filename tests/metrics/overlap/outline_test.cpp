// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/outline.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/units.h"
#include "tests/metrics/overlap/drawn_edges.h"

namespace glint {
namespace {

double area_of(const ImageF& coverage) {
  return std::accumulate(coverage.values().begin(), coverage.values().end(), 0.0);
}

Boundary polygon(const std::vector<Eigen::Vector2d>& corners) {
  Boundary line = {.points = {}, .is_closed = true};
  for (const Eigen::Vector2d& corner : corners) {
    line.points.push_back({.at_px = corner});
  }
  return line;
}

// Columns 1.25 to 4.5 and rows 1 to 3: 3.25 x 2 pixels.
TEST(Filled, HasTheSharesOfPixels) {
  const Boundary box = polygon({{1.25, 1.0}, {4.5, 1.0}, {4.5, 3.0}, {1.25, 3.0}});
  const ImageF coverage = filled({&box, 1}, 8, 5);
  EXPECT_FLOAT_EQ(coverage(1, 1), 0.75F);
  EXPECT_FLOAT_EQ(coverage(2, 2), 1.0F);
  EXPECT_FLOAT_EQ(coverage(4, 2), 0.5F);
  EXPECT_FLOAT_EQ(coverage(5, 2), 0.0F);
  EXPECT_FLOAT_EQ(coverage(2, 3), 0.0F);
  EXPECT_NEAR(area_of(coverage), 6.5, 1e-6);
}

TEST(Filled, LeavesHolesOpenAndStaysInThePicture) {
  const std::vector<Boundary> ring = {polygon({{-3, -3}, {9, -3}, {9, 9}, {-3, 9}}),
                                      polygon({{2, 2}, {2, 4}, {4, 4}, {4, 2}})};
  EXPECT_NEAR(area_of(filled(ring, 6, 6)), 32.0, 1e-6);
}

Mask disc_mask(int size, double radius, int factor) {
  Mask mask(size / factor, size / factor);
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      const double middle = 0.5 * size;
      mask(x, y) = std::hypot((x + 0.5) * factor - middle, (y + 0.5) * factor - middle) < radius;
    }
  }
  return mask;
}

// A disc of radius 70.3 segmented at a quarter of the size, refined in the whole picture.
TEST(Refined, OutlineOfAQuarterHasTheAreaOfTheDisc) {
  const ImageF picture = drawn_disc(200, 100.0, 100.0, 70.3, 0.8);
  const auto rough = outlines_of(disc_mask(200, 70.3, 4), 4);
  ASSERT_EQ(rough.size(), 1U);
  EXPECT_GT(rough[0].points.size(), 380U);
  const double area = kPi * 70.3 * 70.3;
  const auto edges = locate_edges(picture, rough, {.reach_px = 6.0});
  EXPECT_GT(edges.size(), 0.97 * static_cast<double>(rough[0].points.size()));
  EXPECT_NEAR(area_of(filled(refined(rough, edges), 200, 200)), area, 0.0005 * area);
}

TEST(OutlinesOf, AreClosedWhereTheRegionLeavesThePicture) {
  Mask half(40, 30);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 20; ++x) {
      half(x, y) = 1;
    }
  }
  const auto outlines = outlines_of(half, 2);
  ASSERT_EQ(outlines.size(), 1U);
  EXPECT_TRUE(outlines[0].is_closed);
  EXPECT_NEAR(area_of(filled(outlines, 80, 60)), 40.0 * 60.0, 20.0);
}

}  // namespace
}  // namespace glint
