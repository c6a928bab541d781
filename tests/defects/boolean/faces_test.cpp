// SPDX-License-Identifier: GPL-3.0-or-later
//
// What imprints are made of: boxes around faces, faces that cross, polygons cut into triangles, and
// what lies inside a tool.
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "defects/boolean/box_tree.h"
#include "defects/boolean/corefine_polygon.h"
#include "defects/boolean/imprint_checks.h"
#include "defects/boolean/patch_crossings.h"
#include "defects/boolean/patch_tool.h"
#include "tests/defects/boolean/imprint_support.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using imprint_support::ball_at;
using imprint_support::random_point;

TEST(BoxTree, FindsWhatLookingAtEveryBoxFinds) {
  Rng rng(1, Stream::kTest, 0);
  std::vector<FloatBox> boxes;
  for (int i = 0; i < 1500; ++i) {
    const Vector3d a = random_point(rng, 10.0);
    boxes.push_back(box_of(a, a + random_point(rng, 1.0), a + random_point(rng, 1.0)));
  }
  const BoxTree tree(boxes);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d a = random_point(rng, 10.0);
    const FloatBox query = box_of(a, a + random_point(rng, 3.0), a);
    std::vector<std::int32_t> expected;
    for (std::size_t j = 0; j < boxes.size(); ++j) {
      if (boxes[j].overlaps(query)) {
        expected.push_back(static_cast<std::int32_t>(j));
      }
    }
    std::vector<std::int32_t> found;
    tree.visit(query, [&](std::int32_t index) { found.push_back(index); });
    EXPECT_THAT(found, testing::UnorderedElementsAreArray(expected));
  }
}

TEST(FloatBox, IsNeverSmallerThanTheTriangle) {
  Rng rng(2, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d p = random_point(rng, 1e3);
    const FloatBox point = box_of(p, p, p);
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      EXPECT_LT(static_cast<double>(point.min_mm[axis]), p[k]);
      EXPECT_GT(static_cast<double>(point.max_mm[axis]), p[k]);
      EXPECT_NEAR(static_cast<double>(point.max_mm[axis]),
                  static_cast<double>(point.min_mm[axis]),
                  1e-6 * std::abs(p[k]) + 1e-30);
    }
  }
}

TEST(FacesCross, AgreesWithExactPredicates) {
  Rng rng(3, Stream::kTest, 0);
  // On a grid of 5^3 points most pairs are special: in one plane, touching, in line.
  const auto grid_point = [&] { return Vector3d((random_point(rng, 2.49)).array().round()); };
  int num_crossing = 0;
  int num_apart = 0;
  while (num_crossing < 500 || num_apart < 500) {
    const TestFace a({0, 1, 2}, {grid_point(), grid_point(), grid_point()});
    const TestFace b({3, 4, 5}, {grid_point(), grid_point(), grid_point()});
    if (is_degenerate(a) || is_degenerate(b)) {
      continue;
    }
    const bool is_crossing = triangles_intersect(a.corners, b.corners);
    EXPECT_EQ(faces_cross(a, b), is_crossing);
    EXPECT_TRUE(may_intersect(a, b) || !is_crossing);
    (is_crossing ? num_crossing : num_apart) += 1;
    const TestFace c({0, 4, 5}, {a.corners[0], b.corners[1], b.corners[2]});
    if (!is_degenerate(c)) {
      EXPECT_EQ(faces_cross(a, c), triangles_cross_at_corner(a.corners, c.corners));
    }
    const TestFace d({1, 0, 5}, {a.corners[1], a.corners[0], b.corners[2]});
    if (!is_degenerate(d)) {
      const Corners same = {a.corners[0], a.corners[1], b.corners[2]};
      EXPECT_EQ(faces_cross(a, d), triangles_cross_at_edge(a.corners, same));
    }
  }
}

TEST(Triangulate, FillsPolygonsWithHolesByTheirArea) {
  Rng rng(4, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    std::vector<Vector2d> points;
    Polygon outer;
    Polygon hole;
    for (int k = 0; k < 20; ++k) {
      const double angle = 2.0 * kPi * k / 20;
      const double radius = rng.uniform(1.0, 3.0);
      outer.push_back(static_cast<std::int32_t>(points.size()));
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    for (int k = 9; k >= 0; --k) {  // clockwise, inside radius 1 cos(9 deg) = 0.98
      const double angle = 2.0 * kPi * (k + 0.3) / 10;
      const double radius = rng.uniform(0.2, 0.9);
      hole.push_back(static_cast<std::int32_t>(points.size()));
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    std::vector<Triangle> triangles;
    ASSERT_TRUE(triangulate(points, outer, {hole}, triangles));
    // n + 2 h - 2 triangles, h holes: 30 + 2 - 2.
    EXPECT_EQ(triangles.size(), 30U);
    double area = 0.0;
    for (const Triangle& t : triangles) {
      const double doubled = doubled_area(points, {t[0], t[1], t[2]});
      EXPECT_GT(doubled, 0.0);
      area += doubled;
    }
    EXPECT_NEAR(area, doubled_area(points, outer) + doubled_area(points, hole), 1e-12);
  }
}

TEST(Triangulate, FillsPolygonsWithCornersInLine) {
  // A triangle with ten more points on its base: 11 triangles, and no flat one.
  std::vector<Vector2d> points = {{0.3, 1.0}};
  Polygon outer = {0};
  for (int i = 0; i <= 11; ++i) {
    points.emplace_back(0.1 * i, 0.1 + 0.01 * i);
    outer.push_back(i + 1);
  }
  std::vector<Triangle> triangles;
  ASSERT_TRUE(triangulate(points, outer, {}, triangles));
  EXPECT_EQ(triangles.size(), 11U);
  for (const Triangle& t : triangles) {
    EXPECT_GT(doubled_area(points, {t[0], t[1], t[2]}), 1e-3);
  }
}

TEST(PatchTool, ContainsThePointsInsideABall) {
  const PatchTool tool(ball_at({1.0, 2.0, 3.0}, 2.0, 3));
  Rng rng(5, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d offset = random_point(rng, 3.0);
    if (std::abs(offset.norm() - 2.0) > 0.05) {  // the ball's faces lie up to 0.02 inside
      EXPECT_EQ(tool.contains(Vector3d(1.0, 2.0, 3.0) + offset), offset.norm() < 2.0);
    }
  }
}

}  // namespace
}  // namespace glint
