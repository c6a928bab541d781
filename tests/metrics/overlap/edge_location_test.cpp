// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/edge_location.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "tests/metrics/overlap/drawn_edges.h"

namespace glint {
namespace {

using Eigen::Vector2d;

/// A straight edge through a place near the middle of 32 x 32 pixels.
struct StraightEdge {
  Vector2d normal;
  double place_px = 0.0;  ///< along the normal from the middle
  double blur_px = 0.0;
};

StraightEdge random_edge(std::uint64_t index) {
  Rng rng(7, Stream::kTest, index);
  const double angle = rng.uniform(0.0, 2.0 * kPi);
  return {.normal = {std::cos(angle), std::sin(angle)},
          .place_px = rng.uniform(-1.5, 1.5),
          .blur_px = rng.uniform(0.3, 1.4)};
}

ImageF drawn_edge(const StraightEdge& edge) {
  return drawn(32, 32, [&](double x, double y) {
    const double ahead = edge.normal.dot(Vector2d(x - 16.0, y - 16.0)) - edge.place_px;
    return 0.2 + 0.5 * 0.5 * std::erfc(ahead / (std::sqrt(2.0) * edge.blur_px));
  });
}

std::vector<Boundary> from_the_middle(const Vector2d& normal) {
  return {{.points = {{.at_px = {16.0, 16.0}, .normal = normal}}}};
}

TEST(LocateEdges, FindsStraightEdgesOfAnyDirectionAndBlur) {
  double worst = 0.0;
  double sum = 0.0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const StraightEdge edge = random_edge(i);
    const auto found = locate_edges(drawn_edge(edge), from_the_middle(edge.normal));
    ASSERT_EQ(found.size(), 1U) << i;
    worst = std::max(worst, std::abs(found[0].moved_px - edge.place_px));
    sum += found[0].moved_px - edge.place_px;
    EXPECT_NEAR(found[0].contrast, 0.5, 0.05);
  }
  EXPECT_LT(worst, 0.05);
  EXPECT_LT(std::abs(sum / 1000.0), 0.002);
}

// What the fit says of its own error is what noise does to it, within a factor.
TEST(LocateEdges, KnowsHowFarNoiseMovesAnEdge) {
  double squares = 0.0;
  int count = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const StraightEdge edge = random_edge(i);
    ImageF picture = drawn_edge(edge);
    add_normal_noise(picture, 0.02, i);
    for (const LocatedEdge& found : locate_edges(picture, from_the_middle(edge.normal))) {
      squares += std::pow((found.moved_px - edge.place_px) / found.sigma_px, 2);
      ++count;
    }
  }
  EXPECT_GT(count, 980);
  EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.35);
}

// A disc of radius 40.2 whose search begins at a circle of 41.7.
TEST(LocateEdges, FindsACircleToATwentiethOfAPixel) {
  const ImageF disc = drawn_disc(120, 60.3, 58.7, 40.2, 0.7);
  Boundary start = {.points = {}, .is_closed = true};
  for (int i = 0; i < 260; ++i) {
    const double angle = 2.0 * kPi * i / 260.0;
    const Vector2d out(std::cos(angle), std::sin(angle));
    start.points.push_back({.at_px = Vector2d(60.3, 58.7) + 41.7 * out, .normal = out});
  }
  const auto found = locate_edges(disc, {&start, 1});
  ASSERT_EQ(found.size(), 260U);
  for (const LocatedEdge& edge : found) {
    EXPECT_NEAR(edge.moved_px, -1.5, 0.05);
  }
  const auto lines = joined(found, {&start, 1});
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].is_closed);
}

TEST(LocateEdges, LeavesOutWhatIsNoEdge) {
  ImageF noise(32, 32, 0.5F);
  add_normal_noise(noise, 0.002, 1);
  EXPECT_TRUE(locate_edges(noise, from_the_middle(Vector2d::UnitX())).empty());
  // Far from the middle, and beyond the picture.
  const StraightEdge far = {.normal = Vector2d::UnitX(), .place_px = 9.0, .blur_px = 0.5};
  EXPECT_TRUE(locate_edges(drawn_edge(far), from_the_middle(far.normal)).empty());
  const std::vector<Boundary> outside = {{.points = {{.at_px = {1.0, 16.0}}}}};
  EXPECT_TRUE(locate_edges(drawn_edge(far), outside).empty());
}

TEST(Joined, BreaksWherePointsAreMissing) {
  Boundary line;
  std::vector<LocatedEdge> edges;
  for (std::size_t i = 0; i < 30; ++i) {
    line.points.push_back({.at_px = {static_cast<double>(i), 0.0}});
    if (i < 10 || i >= 20) {
      edges.push_back({.boundary = 0, .point = i, .edge = line.points.back()});
    }
  }
  const auto lines = joined(edges, {&line, 1});
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].points.size(), 10U);
  EXPECT_EQ(lines[1].points.size(), 10U);
}

}  // namespace
}  // namespace glint
