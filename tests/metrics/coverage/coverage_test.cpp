// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/coverage/coverage.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Core>

#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"
#include "metrics/coverage/patches.h"
#include "metrics/coverage/separation.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Three views of four points:  point    0 1 2 3
///                              view 0   x x . .
///                              view 1   . x x .
///                              view 2   . x . .
Visibility three_views() {
  Visibility visibility(3, 4);
  visibility.set(0, 0);
  visibility.set(0, 1);
  visibility.set(1, 1);
  visibility.set(1, 2);
  visibility.set(2, 1);
  return visibility;
}

constexpr std::array kWeights = {1.0, 2.0, 3.0, 4.0};

// Weights 1 2 3 4, together 10. Seen: points 0 (once), 1 (three times), 2 (once).
// C1 = (1 + 2 + 3) / 10, C2 = C3 = 2 / 10; redundancy = (1 + 3 * 2 + 3) / 10.
TEST(CoverageOf, MatchesAHandWorkedExample) {
  const Coverage coverage = coverage_of(three_views(), kWeights, 4);
  EXPECT_THAT(coverage.ck,
              ElementsAre(DoubleNear(0.6, 1e-15),
                          DoubleNear(0.2, 1e-15),
                          DoubleNear(0.2, 1e-15),
                          DoubleNear(0.0, 1e-15)));
  EXPECT_NEAR(coverage.redundancy, 1.0, 1e-15);
  ASSERT_EQ(coverage.views.size(), 3U);
  EXPECT_NEAR(coverage.views[0].sees, 0.3, 1e-15);
  EXPECT_NEAR(coverage.views[0].adds, 0.3, 1e-15);
  EXPECT_NEAR(coverage.views[0].only, 0.1, 1e-15);
  EXPECT_NEAR(coverage.views[1].sees, 0.5, 1e-15);
  EXPECT_NEAR(coverage.views[1].adds, 0.3, 1e-15);
  EXPECT_NEAR(coverage.views[1].only, 0.3, 1e-15);
  EXPECT_NEAR(coverage.views[2].adds, 0.0, 1e-15);
  EXPECT_NEAR(coverage.views[2].only, 0.0, 1e-15);
}

TEST(CoverageOf, WhatViewsAddSumsToC1) {
  Rng rng(1, Stream::kTest, 0);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto views = static_cast<std::size_t>(1 + 8.0 * rng.uniform());
    const auto points = static_cast<std::size_t>(1 + 150.0 * rng.uniform());
    Visibility visibility(views, points);
    std::vector<double> weights(points);
    for (std::size_t i = 0; i < points; ++i) {
      weights[i] = 0.01 + rng.uniform();
      for (std::size_t v = 0; v < views; ++v) {
        if (rng.uniform() < 0.3) {
          visibility.set(v, i);
        }
      }
    }
    const Coverage coverage = coverage_of(visibility, weights, 9);
    double adds = 0.0;
    double sum_of_ck = 0.0;
    for (const ViewShare& view : coverage.views) {
      adds += view.adds;
      EXPECT_LE(view.only, view.adds + 1e-12);
      EXPECT_LE(view.adds, view.sees + 1e-12);
    }
    for (std::size_t k = 0; k < coverage.ck.size(); ++k) {
      sum_of_ck += coverage.ck[k];
      EXPECT_LE(coverage.ck[k], k == 0 ? 1.0 + 1e-12 : coverage.ck[k - 1]);
    }
    EXPECT_NEAR(adds, coverage.c1(), 1e-12);
    EXPECT_NEAR(sum_of_ck, coverage.redundancy, 1e-12);  // at most 8 views see a point
  }
}

TEST(CoverageOf, IsNothingWithoutViews) {
  const Coverage coverage = coverage_of(Visibility(0, 4), kWeights, 2);
  EXPECT_EQ(coverage.c1(), 0.0);
  EXPECT_EQ(coverage.redundancy, 0.0);
  EXPECT_TRUE(coverage.views.empty());
}

TEST(CoverageOf, RefusesWeightsThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto cover = [](std::array<double, 4> weights) {
    return [weights] { coverage_of(three_views(), weights, 1); };
  };
  EXPECT_THAT(cover({1.0, -2.0, 3.0, 4.0}),
              ThrowsMessage<ConfigError>(HasSubstr("weight 1 is -2")));
  EXPECT_THAT(cover({1.0, 2.0, nan, 4.0}),
              ThrowsMessage<ConfigError>(HasSubstr("weight 2 is nan")));
  EXPECT_THAT(cover({0.0, 0.0, 0.0, 0.0}), ThrowsMessage<ConfigError>(HasSubstr("together are 0")));
}

Vector3d direction(double degrees) {
  return {std::sin(degrees * kRadPerDeg), 0.0, std::cos(degrees * kRadPerDeg)};
}

// At 0, 10, 20 degrees: taking the middle one first leaves it alone, 0 and 20 are two.
TEST(SeparatedCount, IsTheLargestChoiceNotTheFirst) {
  const std::array directions = {direction(10.0), direction(0.0), direction(20.0)};
  EXPECT_EQ(separated_count(directions, 15.0 * kRadPerDeg, 9), 2);
  EXPECT_EQ(separated_count(directions, 20.0 * kRadPerDeg, 9), 2);
  EXPECT_EQ(separated_count(directions, 20.1 * kRadPerDeg, 9), 1);
  EXPECT_EQ(separated_count(directions, 10.0 * kRadPerDeg, 9), 3);
  EXPECT_EQ(separated_count(directions, 0.0, 9), 3);
  EXPECT_EQ(separated_count(directions, 0.0, 2), 2);
  EXPECT_EQ(separated_count({}, 0.1, 9), 0);
}

/// Directions within an angle of +z, even over the sphere.
std::vector<Vector3d> directions_in_cap(int count, double cap_rad, std::uint64_t index) {
  Rng rng(3, Stream::kTest, index);
  std::vector<Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = rng.uniform(std::cos(cap_rad), 1.0);
    const double turn = rng.uniform(0.0, 2.0 * kPi);
    const double r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return directions;
}

/// Of all subsets.
int separated_of_all(const std::vector<Vector3d>& directions, double separation_rad, int enough) {
  int best = 0;
  for (std::uint32_t subset = 0; subset < 1U << directions.size(); ++subset) {
    bool is_apart = true;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const bool has_both = (subset >> i & subset >> j & 1U) != 0;
        is_apart = is_apart && !(has_both && directions[i].dot(directions[j]) >
                                                 std::cos(separation_rad) + 1e-12);
      }
    }
    best = is_apart ? std::max(best, std::popcount(subset)) : best;
  }
  return std::min(best, enough);
}

TEST(SeparatedCount, EqualsThatOfAllSubsets) {
  std::array<int, 6> cases = {};
  for (int i = 0; i < 100; ++i) {
    const double cap_rad = (7.0 + 0.3 * i) * kRadPerDeg;
    const auto directions = directions_in_cap(9, cap_rad, static_cast<std::uint64_t>(i));
    for (const int enough : {2, 5}) {
      const int count = separated_count(directions, 15.0 * kRadPerDeg, enough);
      EXPECT_EQ(count, separated_of_all(directions, 15.0 * kRadPerDeg, enough)) << i;
      ++cases[static_cast<std::size_t>(count)];
    }
  }
  EXPECT_TRUE(std::ranges::all_of(std::span(cases).subspan(1), [](int n) { return n >= 5; }));
}

// Close together neither a second direction nor a fifth one is sought in all that there are: of 200
// directions that is 2e4 pairs and 6e7 choices of four.
TEST(SeparatedCount, OfManyDirectionsCloseTogetherLooksAtFewChoices) {
  std::int64_t nodes = 0;
  EXPECT_EQ(
      separated_count(directions_in_cap(200, 7.0 * kRadPerDeg, 0), 15.0 * kRadPerDeg, 2, &nodes),
      1);
  EXPECT_LE(nodes, 2);
  EXPECT_EQ(
      separated_count(directions_in_cap(200, 14.0 * kRadPerDeg, 0), 15.0 * kRadPerDeg, 5, &nodes),
      4);
  EXPECT_LE(nodes, 2000);
}

/// A row of points, each linked with the next.
std::vector<std::array<std::int32_t, 2>> row_of(std::int32_t count) {
  std::vector<std::array<std::int32_t, 2>> links;
  for (std::int32_t i = 0; i + 1 < count; ++i) {
    links.push_back({i, i + 1});
  }
  return links;
}

// 1 1 0 1 0 1 1: patches of weight 2, 5 and 1 + 1.
TEST(LargestPatch, IsTheHeaviestConnectedSet) {
  const std::vector<std::uint8_t> is_in = {1, 1, 0, 1, 0, 1, 1};
  const std::vector<double> weights = {1.0, 1.0, 9.0, 5.0, 9.0, 1.0, 1.0};
  const SurfacePatch patch = largest_patch(is_in, weights, row_of(7));
  EXPECT_EQ(patch.weight, 5.0);
  EXPECT_THAT(patch.points, ElementsAre(3U));
  const SurfacePatch even = largest_patch(is_in, std::vector<double>(7, 1.0), row_of(7));
  EXPECT_EQ(even.weight, 2.0);
  EXPECT_THAT(even.points, ElementsAre(0U, 1U));
}

TEST(LargestPatch, IsEmptyWhereNothingIsAskedFor) {
  const SurfacePatch patch =
      largest_patch(std::vector<std::uint8_t>(3), std::vector<double>(3, 1.0), row_of(3));
  EXPECT_EQ(patch.weight, 0.0);
  EXPECT_TRUE(patch.points.empty());
}

}  // namespace
}  // namespace glint
