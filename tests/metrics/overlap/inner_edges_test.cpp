// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/inner_edges.h"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "metrics/overlap/boundary_distance.h"
#include "tests/metrics/overlap/drawn_edges.h"

namespace glint {
namespace {

/// Dark squares of 40 px on bright ground, the second one with its corner at (130, 30).
ImageF squares(double first_x_px, double second_x_px) {
  return drawn(200, 100, [=](double x, double y) {
    const bool is_dark =
        y > 30.0 && y < 70.0 &&
        ((x > first_x_px && x < first_x_px + 40.0) || (x > second_x_px && x < second_x_px + 40.0));
    return is_dark ? 0.1 : 0.8;
  });
}

double distance_px(const ImageF& simulated, const ImageF& real, const Mask& inside = {}) {
  const InnerEdges edges = inner_edges(simulated, real, 0.45F, inside);
  return boundary_distance(edges.simulated, edges.real).mean_px;
}

// Of four equal sides two lie 0.5 px away and two run along the shift: 0.25 px.
TEST(InnerEdges, TellHowFarAPrintHasMoved) {
  const ImageF real = squares(30.5, 130.5);
  EXPECT_NEAR(distance_px(squares(30.0, 130.0), real), 0.25, 0.03);
  EXPECT_LT(distance_px(real, real), 1e-3);
}

TEST(InnerEdges, AreThoseInsideTheMaskAlone) {
  Mask left(200, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      left(x, y) = 1;
    }
  }
  const ImageF simulated = squares(30.0, 130.0);
  const ImageF real = squares(30.0, 133.0);
  EXPECT_NEAR(distance_px(simulated, real, left), 0.0, 0.02);
  EXPECT_GT(distance_px(simulated, real), 0.5);
  EXPECT_EQ(inner_edges(simulated, real, 0.45F, Mask(200, 100)).simulated.size(), 0U);
}

TEST(InnerEdges, AreNoneWhereNothingIsWithinTheReach) {
  const InnerEdges edges = inner_edges(squares(30.0, 130.0), ImageF(200, 100, 0.5F), 0.45F);
  EXPECT_GT(edges.points, 200U);
  EXPECT_EQ(edges.paired, 0U);
  EXPECT_TRUE(edges.real.empty());
  EXPECT_EQ(edges.distance_px(), kInnerReachPx);
}

/// Squares of 7 px, moved along x.
ImageF board(double shift_px) {
  return drawn(112, 112, [=](double x, double y) {
    const int square = static_cast<int>(std::floor((x - shift_px) / 7.0) + std::floor(y / 7.0));
    return square % 2 == 0 ? 0.8 : 0.2;
  });
}

// By one square all dark squares lie on bright ones: what is nearest to an edge is one of the other
// sign. Moved by two squares the board looks as before.
TEST(InnerEdges, AreNoCounterpartsOfTheOtherSign) {
  double last_px = -1.0;
  for (int shift_px = 0; shift_px <= 7; ++shift_px) {
    const InnerEdges edges = inner_edges(board(0.0), board(shift_px), 0.5F);
    std::printf("%d px: %.3f px, of %.2f of the edges %.3f px\n",
                shift_px,
                edges.distance_px(),
                edges.share(),
                edges.mean_px);
    EXPECT_GE(edges.distance_px(), last_px) << shift_px;
    last_px = edges.distance_px();
  }
  EXPECT_GT(last_px, 7.5);
  EXPECT_LT(distance_px(board(0.0), board(0.0)), 1e-9);
  EXPECT_LT(inner_edges(board(0.0), board(14.0), 0.5F).distance_px(), 0.01);
}

// Four squares, and one of them: three quarters of the edges are the reach away.
TEST(InnerEdges, ThatAreMissingCountAsTheReach) {
  const auto printed = [](int count) {
    return drawn(200, 200, [=](double x, double y) {
      const int col = static_cast<int>(x / 100.0);
      const int row = static_cast<int>(y / 100.0);
      const double u = x - 100.0 * col;
      const double v = y - 100.0 * row;
      const bool is_dark = u > 30.0 && u < 70.0 && v > 30.0 && v < 70.0;
      return is_dark && 2 * row + col < count ? 0.1 : 0.8;
    });
  };
  const InnerEdges edges = inner_edges(printed(4), printed(1), 0.45F);
  EXPECT_NEAR(edges.share(), 0.25, 1e-9);
  EXPECT_NEAR(edges.distance_px(), 0.75 * kInnerReachPx, 0.01);
  EXPECT_NEAR(inner_edges(printed(1), printed(4), 0.45F).distance_px(), 0.0, 0.01);
}

// A print of low contrast, its right side 5.5 px from a black bar: the search takes the bar for the
// print there, in both pictures.
TEST(InnerEdges, OfEqualPicturesAgreeBesideEdgesOfMoreContrast) {
  const ImageF picture = drawn(120, 120, [](double x, double y) {
    const bool is_print = x > 30.0 && x < 70.0 && y > 40.0 && y < 80.0;
    const bool is_bar = x > 75.5 && x < 95.5 && y > 20.0 && y < 100.0;
    return is_bar ? 0.0 : (is_print ? 0.6 : 0.8);
  });
  const InnerEdges edges = inner_edges(picture, picture, 0.7F);
  EXPECT_GT(edges.points, 250U);
  EXPECT_EQ(edges.share(), 1.0);
  EXPECT_EQ(edges.distance_px(), 0.0);
  EXPECT_EQ(distance_px(picture, picture), 0.0);
}

// The rim of the inside, of more contrast than the print 6 px within: neither side takes it.
TEST(InnerEdges, AreNotThoseOfARimNearby) {
  const auto part = [](double print) {
    return drawn(120, 120, [=](double x, double y) {
      const bool is_part = x > 20.0 && x < 100.0 && y > 20.0 && y < 100.0;
      const bool is_print = x > 26.0 && x < 60.0 && y > 40.0 && y < 80.0;
      return is_part ? (is_print ? print : 0.8) : 0.0;
    });
  };
  Mask inside(120, 120);
  for (int y = 23; y < 97; ++y) {
    for (int x = 23; x < 97; ++x) {
      inside(x, y) = 1;
    }
  }
  const InnerEdges edges = inner_edges(part(0.6), part(0.6), 0.7F, inside);
  EXPECT_GT(edges.points, 80U);
  EXPECT_EQ(edges.distance_px(), 0.0);
  const InnerEdges strong = inner_edges(part(0.2), part(0.6), 0.5F, inside);
  EXPECT_LT(strong.mean_px, 0.05);
}

}  // namespace
}  // namespace glint
