// SPDX-License-Identifier: GPL-3.0-or-later
//
// How well a whole edge is located, against the bound of its pixels' noise.
#include <cmath>

#include <gtest/gtest.h>

#include "core/units.h"
#include "metrics/overlap/edge_location.h"
#include "tests/metrics/overlap/drawn_edges.h"

namespace glint {
namespace {

constexpr int kPoints = 100;
constexpr double kContrast = 0.5;
constexpr double kBlurPx = 0.8;
constexpr double kGreyNoise = 0.01;
constexpr double kFittedPx = 6.5;  ///< 13 samples half a pixel apart

// g(t) = c Phi(t / s) in white noise sigma tells t0 with the information I = c^2 / (2 sqrt(pi) s
// sigma^2) a pixel of length: the integral of g'^2 over sigma^2. A pixel's area blurs, too: s^2 =
// blur^2 + 1 / 12. Both greys are unknown, and within +- W of the edge their mean is changed by a
// motion of the edge: what the projection of g' on a constant takes away is I 2 sqrt(pi) s / 2W,
// about half. Neighbouring points share two of their three lines, so that n of them
// hold n / 3 independent means: the scatter of one over sqrt(n) is too small by sqrt(3), no bound.
TEST(LocateEdges, OfAWholeEdgeAreNearlyAsGoodAsItsPixelsAllow) {
  const ImageF clean = drawn(40, kPoints + 20, [](double x, double) {
    return 0.2 + kContrast * 0.5 * std::erfc((x - 20.3) / (std::sqrt(2.0) * kBlurPx));
  });
  Boundary line;
  for (int i = 0; i < kPoints; ++i) {
    line.points.push_back({.at_px = {20.0, 10.5 + i}, .normal = {1.0, 0.0}});
  }
  const std::vector<Boundary> lines = {line};
  double means = 0.0;
  double singles = 0.0;
  constexpr int kDraws = 300;
  for (int draw = 0; draw < kDraws; ++draw) {
    ImageF picture = clean;
    add_normal_noise(picture, kGreyNoise, static_cast<std::uint64_t>(draw));
    double sum = 0.0;
    const auto found = locate_edges(picture, lines);
    ASSERT_EQ(found.size(), static_cast<std::size_t>(kPoints));
    for (const LocatedEdge& edge : found) {
      sum += edge.moved_px - 0.3;
      singles += (edge.moved_px - 0.3) * (edge.moved_px - 0.3) / (kDraws * kPoints);
    }
    means += sum * sum / (kPoints * kPoints) / kDraws;
  }
  const double blur_px = std::sqrt(kBlurPx * kBlurPx + 1.0 / 12.0);
  const double width_px = 2.0 * std::sqrt(kPi) * blur_px;
  const double known = kGreyNoise / kContrast * std::sqrt(width_px / kPoints);
  const double bound = known / std::sqrt(1.0 - width_px / kFittedPx);
  std::printf(
      "whole edge %.5f px, bound %.5f px, with both greys known %.5f px, as if points were "
      "independent %.5f px\n",
      std::sqrt(means),
      bound,
      known,
      std::sqrt(singles / kPoints));
  EXPECT_GT(std::sqrt(means), 0.9 * bound);
  EXPECT_LT(std::sqrt(means), 1.1 * bound);
  EXPECT_NEAR(std::sqrt(means * kPoints / singles), std::sqrt(3.0), 0.2);
}

}  // namespace
}  // namespace glint
