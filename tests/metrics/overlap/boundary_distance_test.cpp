// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/boundary_distance.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;

std::vector<Boundary> circle(const Vector2d& middle, double radius, int count) {
  Boundary line = {.points = {}, .is_closed = true};
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    const Vector2d out(std::cos(angle), std::sin(angle));
    line.points.push_back({.at_px = middle + radius * out, .normal = out});
  }
  return {line};
}

TEST(BoundaryDistance, OfTwoCirclesIsTheDifferenceOfTheirRadii) {
  const BoundaryDistance distance =
      boundary_distance(circle({200, 200}, 100.0, 900), circle({200, 200}, 100.3, 900));
  EXPECT_NEAR(distance.mean_px, 0.3, 1e-3);
  EXPECT_NEAR(distance.p95_px, 0.3, 1e-3);
  EXPECT_NEAR(distance.offset_px, 0.3, 1e-3);
  EXPECT_EQ(distance.points, 1800U);
  EXPECT_DOUBLE_EQ(distance.share, 1.0);
}

// A circle moved by d: |d cos| has the mean 2 d / pi and the 95th percentile d sin(0.95 pi / 2);
// the signed offset is 0.
TEST(BoundaryDistance, OfAMovedCircleIsTheMeanOfACosine) {
  const double d = 0.4;
  const BoundaryDistance distance =
      boundary_distance(circle({200, 200}, 100.0, 2000), circle({200 + d, 200}, 100.0, 2000));
  EXPECT_NEAR(distance.mean_px, 2.0 * d / kPi, 2e-3);
  EXPECT_NEAR(distance.p95_px, d * std::sin(0.95 * kPi / 2.0), 2e-3);
  EXPECT_NEAR(distance.max_px, d, 2e-3);
  EXPECT_NEAR(distance.offset_px, 0.0, 2e-3);
}

TEST(BoundaryDistance, LeavesOutWhatHasNoNeighbour) {
  std::vector<Boundary> first = circle({50, 50}, 20.0, 100);
  first.push_back(circle({200, 200}, 20.0, 100).front());
  const BoundaryDistance distance = boundary_distance(first, circle({50, 50}, 21.0, 100), 5.0);
  EXPECT_EQ(distance.points, 200U);
  EXPECT_NEAR(distance.share, 2.0 / 3.0, 1e-12);
  EXPECT_EQ(boundary_distance(first, {}, 5.0).points, 0U);
}

// Points beside a loose end have no counterpart there; those beside the line have.
TEST(GapsBetween, LeavesOutPointsBesideALooseEnd) {
  Boundary whole;
  Boundary part;
  for (int i = 0; i < 40; ++i) {
    whole.points.push_back({.at_px = {static_cast<double>(i), 5.0}, .normal = {0.0, 1.0}});
    if (i < 20) {
      part.points.push_back({.at_px = {static_cast<double>(i), 6.0}, .normal = {0.0, 1.0}});
    }
  }
  const auto gaps = gaps_between({&whole, 1}, {&part, 1}, 30.0);
  ASSERT_EQ(gaps.size(), 20U);
  EXPECT_NEAR(gaps[7].offset_px, 1.0, 1e-12);
}

double distance_to(const Vector2d& point, const Vector2d& a, const Vector2d& b) {
  const double t = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (point - a - t * (b - a)).norm();
}

// Against all stretches one by one.
TEST(GapsBetween, FindsTheNearestOfAllStretches) {
  Rng rng(5, Stream::kTest, 0);
  Boundary line = {.points = {}, .is_closed = true};
  for (int i = 0; i < 400; ++i) {
    const double angle = 2.0 * kPi * i / 400.0;
    const double radius = 60.0 + 15.0 * std::sin(7.0 * angle) + rng.uniform(-0.3, 0.3);
    line.points.push_back(
        {.at_px = {100.0 + radius * std::cos(angle), 100.0 + radius * std::sin(angle)}});
  }
  Boundary from;
  for (int i = 0; i < 1000; ++i) {
    from.points.push_back({.at_px = {rng.uniform(20.0, 180.0), rng.uniform(20.0, 180.0)}});
  }
  const auto gaps = gaps_between({&from, 1}, {&line, 1}, 200.0);
  ASSERT_EQ(gaps.size(), 1000U);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    double least = 1e9;
    for (std::size_t k = 0; k < 400; ++k) {
      least = std::min(
          least,
          distance_to(
              from.points[i].at_px, line.points[k].at_px, line.points[(k + 1) % 400].at_px));
    }
    ASSERT_NEAR(gaps[i].distance_px, least, 1e-9) << i;
  }
}

}  // namespace
}  // namespace glint
