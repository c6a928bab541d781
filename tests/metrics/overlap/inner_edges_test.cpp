// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/inner_edges.h"

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
  EXPECT_GE(edges.simulated.size(), 2U);
  EXPECT_TRUE(edges.real.empty());
}

}  // namespace
}  // namespace glint
