// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/part_edges.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;

/// A circle, its normals outwards or to its middle.
Boundary circle(const Vector2d& middle, double radius, double outward) {
  Boundary boundary{.is_closed = true};
  const int count = static_cast<int>(2.0 * kPi * radius);
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    const Vector2d ray(std::cos(angle), std::sin(angle));
    boundary.points.push_back({.at_px = middle + radius * ray, .normal = outward * ray});
  }
  return boundary;
}

// A disk with a bore; the real bore lies 0.8 px to the right, the disk is right.
TEST(PartEdges, TellWhichEdgeIsOff) {
  const std::vector<Boundary> simulated = {circle({50, 50}, 10, -1.0), circle({50, 50}, 40, 1.0)};
  const std::vector<Boundary> real = {circle({50.8, 50}, 10, -1.0), circle({50, 50}, 40, 1.0)};
  const auto edges = part_edges(simulated, simulated, gaps_between(simulated, real)).edges;
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_EQ(edges[0].name, "outline 1");
  EXPECT_NEAR(edges[0].mean_px, 0.0, 0.02);
  EXPECT_EQ(edges[1].name, "hole 1");
  EXPECT_NEAR(edges[1].middle_px.x(), 50.0, 0.1);
  // 0.8 |cos| on average: 0.8 x 2 / pi = 0.51.
  EXPECT_NEAR(edges[1].mean_px, 0.51, 0.03);
  EXPECT_NEAR(edges[1].offset_px, 0.0, 0.03);
  EXPECT_NEAR(edges[1].shift_px.x(), 0.8, 0.03);
  EXPECT_NEAR(edges[1].shift_px.y(), 0.0, 0.03);
}

TEST(PartEdges, OfAStraightLineTellNoShift) {
  Boundary line;
  Boundary other;
  for (int i = 0; i < 60; ++i) {
    line.points.push_back({.at_px = {20.0 + i, 30.0}, .normal = {0.0, 1.0}});
    other.points.push_back({.at_px = {10.5 + 1.5 * i, 30.4}, .normal = {0.0, 1.0}});
  }
  const std::vector<Boundary> simulated = {line};
  const std::vector<Boundary> real = {other};
  const auto edges = part_edges(simulated, simulated, gaps_between(simulated, real)).edges;
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].name, "line 1");
  EXPECT_NEAR(edges[0].offset_px, 0.4, 1e-6);
  EXPECT_EQ(edges[0].shift_px, Vector2d::Zero());
}

TEST(PartEdges, AreNoneWithoutCounterparts) {
  const std::vector<Boundary> simulated = {circle({50, 50}, 10, 1.0)};
  EXPECT_TRUE(part_edges(simulated, simulated, {}).edges.empty());
  EXPECT_TRUE(part_edges({}, {}, {}).edges.empty());
}

// 35 creases of 100 points, 10 pieces of the outline of 25 and 2 of 19, which are too short. Of 47
// edges 40 are listed; of the outline 250 points of 298, ten of which belong to no edge.
TEST(PartEdges, TellWhatTheyLeaveOutAndKeepTheOutline) {
  std::vector<PartEdge> edges(35, {.name = kCrease, .points = 100});
  edges.insert(edges.end(), 10, {.name = "outline", .points = 25});
  edges.insert(edges.end(), 2, {.name = "outline", .points = 19});
  const ListedEdges listed = list_edges(edges, 10 * 25 + 2 * 19 + 10);
  ASSERT_EQ(listed.edges.size(), 40U);
  EXPECT_EQ(listed.edges[0].name, "crease 1");
  EXPECT_EQ(listed.edges[29].name, "crease 30");
  EXPECT_EQ(listed.edges[30].name, "outline 1");
  EXPECT_EQ(listed.edges[39].name, "outline 10");
  EXPECT_EQ(listed.unlisted.count, 7U);
  EXPECT_NEAR(listed.unlisted.outline_share, 48.0 / 298.0, 1e-12);
}

TEST(PartEdges, LeaveOutNothingWithoutAWord) {
  const std::vector<Boundary> simulated = {circle({50, 50}, 2.5, -1.0), circle({50, 50}, 40, 1.0)};
  const std::vector<Boundary> real = {circle({50, 50}, 2.5, -1.0), circle({50, 50}, 40.5, 1.0)};
  const ListedEdges listed = part_edges(simulated, simulated, gaps_between(simulated, real));
  ASSERT_EQ(listed.edges.size(), 1U);
  EXPECT_EQ(listed.unlisted.count, 1U);
  EXPECT_NEAR(listed.unlisted.outline_share, 15.0 / (15.0 + 251.0), 1e-3);
  EXPECT_EQ(list_edges({}, 0).unlisted.outline_share, 0.0);
}

}  // namespace
}  // namespace glint
