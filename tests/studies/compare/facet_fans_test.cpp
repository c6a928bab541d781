// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/facet_fans.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

constexpr double kPixel_mm = 0.05;

/// A quadrilateral, its normal by the right hand.
FlatPiece quadrilateral(const Vector3d& a,
                        const Vector3d& b,
                        const Vector3d& c,
                        const Vector3d& d) {
  return {.normal = (b - a).cross(c - a).normalized(),
          .middle_mm = 0.25 * (a + b + c + d),
          .points_mm = {a, b, c, d}};
}

/// Some neighbouring sides of a frustum of so many sides about z, outwards; its radii at the
/// corners. One radius: a prism.
std::vector<FlatPiece> sides(
    int around, int seen, double foot_mm, double top_mm, double height_mm) {
  const auto corner = [&](int i, double radius, double z) {
    const double angle = 2.0 * kPi * i / around;
    return Vector3d(3.0 + radius * std::cos(angle), -4.0 + radius * std::sin(angle), z);
  };
  std::vector<FlatPiece> pieces;
  for (int i = 0; i < seen; ++i) {
    pieces.push_back(quadrilateral(corner(i, foot_mm, 0.0),
                                   corner(i + 1, foot_mm, 0.0),
                                   corner(i + 1, top_mm, height_mm),
                                   corner(i, top_mm, height_mm)));
  }
  return pieces;
}

Pairs in_a_row(std::size_t count) {
  Pairs pairs;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    pairs.emplace_back(i, i + 1);
  }
  return pairs;
}

/// A profile in x and z, drawn out along y; its outside to the left as one goes.
std::vector<FlatPiece> drawn_out(const std::vector<std::pair<double, double>>& profile) {
  std::vector<FlatPiece> pieces;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const Vector3d a(profile[i].first, 0.0, profile[i].second);
    const Vector3d b(profile[i + 1].first, 0.0, profile[i + 1].second);
    pieces.push_back(
        quadrilateral(a, b, b + 20.0 * Vector3d::UnitY(), a + 20.0 * Vector3d::UnitY()));
  }
  return pieces;
}

TEST(FacetFans, AreCylindersOfTwelveFacetsAndMore) {
  for (const int around : {12, 16, 24, 90}) {
    const auto pieces = sides(around, 5, 18.0, 18.0, 30.0);
    const auto fans = facet_fans(pieces, in_a_row(5), kPixel_mm);
    ASSERT_EQ(fans.size(), 1U) << around;
    EXPECT_THAT(fans[0].pieces, ElementsAre(0, 1, 2, 3, 4));
    EXPECT_NEAR(fans[0].shape.step_rad, 2.0 * kPi / around, 1e-9);
  }
}

// A bore's normals lead to its axis.
TEST(FacetFans, AreBoresToo) {
  auto pieces = sides(24, 6, 5.0, 5.0, 30.0);
  for (FlatPiece& piece : pieces) {
    piece.normal = -piece.normal;
  }
  EXPECT_EQ(facet_fans(pieces, in_a_row(6), kPixel_mm).size(), 1U);
}

// A whole cone, with its tip: facets are as wide at the foot as 1.5 times their middle's share.
TEST(FacetFans, AreConesToo) {
  for (const double top_mm : {0.01, 6.0}) {
    const auto fans = facet_fans(sides(24, 9, 12.0, top_mm, 10.0), in_a_row(9), kPixel_mm);
    ASSERT_EQ(fans.size(), 1U) << top_mm;
    EXPECT_EQ(fans[0].pieces.size(), 9U);
    EXPECT_NEAR(fans[0].shape.step_rad, 15.0 * kRadPerDeg, 1e-9);
  }
}

// Nuts are no cylinders: 6, 8 and 10 sides have 60, 45 and 36 degrees.
TEST(FacetFans, AreNoPrisms) {
  for (const int around : {6, 8, 10}) {
    const auto count = static_cast<std::size_t>(around);
    auto neighbours = in_a_row(count);
    neighbours.emplace_back(0, count - 1);
    EXPECT_TRUE(facet_fans(sides(around, around, 18.0, 18.0, 30.0), neighbours, kPixel_mm).empty());
  }
}

// Chamfers of 45 degrees, and two of 30 and 60 degrees that leave equal angles between the sides of
// a box: those are wider than facets would be.
TEST(FacetFans, AreNoChamfers) {
  const auto once = drawn_out({{0, 0}, {0, 19}, {1, 20}, {39, 20}, {40, 19}, {40, 0}});
  EXPECT_TRUE(facet_fans(once, in_a_row(5), kPixel_mm).empty());
  const double s = std::sin(30.0 * kRadPerDeg);
  const double c = std::cos(30.0 * kRadPerDeg);
  const auto twice =
      drawn_out({{0, 0}, {0, 20}, {s, 20 + c}, {s + c, 20 + c + s}, {40, 20 + c + s}});
  EXPECT_NEAR(std::acos(twice[0].normal.dot(twice[1].normal)), 30.0 * kRadPerDeg, 1e-9);
  EXPECT_TRUE(facet_fans(twice, in_a_row(4), kPixel_mm).empty());
}

// A rounding of radius 4 in six facets between two sides: the facets are it, the sides are not.
TEST(FacetFans, EndWhereTheSidesBegin) {
  std::vector<std::pair<double, double>> profile = {{-4.0, -30.0}};
  for (int i = 0; i <= 6; ++i) {
    const double angle = kPi - i * 15.0 * kRadPerDeg;
    profile.emplace_back(4.0 * std::cos(angle), 4.0 * std::sin(angle));
  }
  profile.emplace_back(30.0, 4.0);
  const auto fans = facet_fans(drawn_out(profile), in_a_row(8), kPixel_mm);
  ASSERT_EQ(fans.size(), 1U);
  EXPECT_THAT(fans[0].pieces, ElementsAre(1, 2, 3, 4, 5, 6));
}

// Equal angles about one axis are not enough: these planes touch no common cylinder.
TEST(FacetFans, TouchOneCylinder) {
  auto pieces = sides(24, 6, 18.0, 18.0, 30.0);
  for (std::size_t i = 0; i < pieces.size(); i += 2) {
    const Vector3d out = 1.5 * pieces[i].normal;
    pieces[i].middle_mm += out;
    for (Vector3d& point : pieces[i].points_mm) {
      point += out;
    }
  }
  EXPECT_TRUE(facet_fans(pieces, in_a_row(6), kPixel_mm).empty());
}

// What was not told apart into facets is of the fan where it touches its shape, whatever mix of
// facets it is; another cylinder and the top of this one are not.
TEST(FacetFans, HoldWhatTouchesThem) {
  const auto fans = facet_fans(sides(24, 6, 18.0, 18.0, 30.0), in_a_row(6), kPixel_mm);
  ASSERT_EQ(fans.size(), 1U);
  const auto points_of = [](const std::vector<FlatPiece>& pieces) {
    std::vector<PointWithNormal> points;
    for (const FlatPiece& piece : pieces) {
      for (const Vector3d& at : piece.points_mm) {
        points.push_back({.at_mm = at, .normal = piece.normal});
      }
    }
    return points;
  };
  EXPECT_TRUE(fans[0].shape.holds(points_of(sides(24, 11, 18.0, 18.0, 30.0)), kPixel_mm));
  EXPECT_FALSE(fans[0].shape.holds(points_of(sides(24, 11, 17.0, 17.0, 30.0)), kPixel_mm));
  EXPECT_FALSE(fans[0].shape.holds(points_of(sides(24, 11, 18.0, 14.0, 30.0)), kPixel_mm));
}

// Three facets are too few to tell, and what is not beside each other is not joined.
TEST(FacetFans, HaveFourNeighbours) {
  const auto pieces = sides(24, 7, 18.0, 18.0, 30.0);
  EXPECT_TRUE(facet_fans(pieces, Pairs{{0, 1}, {1, 2}, {4, 5}, {5, 6}}, kPixel_mm).empty());
  EXPECT_TRUE(facet_fans(pieces, Pairs{}, kPixel_mm).empty());
  EXPECT_TRUE(facet_fans({}, Pairs{}, kPixel_mm).empty());
}

}  // namespace
}  // namespace glint
