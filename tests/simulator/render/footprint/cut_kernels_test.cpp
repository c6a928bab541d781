// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/cut_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/footprint/cell_sum.h"
#include "simulator/render/footprint/cut_limits.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

constexpr cut_kernels::CutLimits kLimits = {
    .half_slot_mm = 8.0, .x_low_mm = -100.0F, .x_high_mm = 100.0F, .no_hit_below_mm = -1e20F};

/// A tunnel of period 12 mm and 6 frames, its slot +-8 mm.
ScanPositions cut_positions(double duty, double dark_radiance) {
  TunnelSettings settings = test::bench_tunnel();
  settings.duty = duty;
  ScanPositions black(Tunnel(settings), {.positions = 6});
  ScanPositions positions = black;
  positions.shine(black, dark_radiance);
  return positions;
}

/// Pixels by their corners, as one batch and as hits with four rays a pixel.
struct CutPixels {
  cut_kernels::CornerBatch batch;
  WallHits hits;
  std::vector<float> weight;

  struct Plane {
    double value = 0.0, dx = 0.0, dy = 0.0, twist = 0.0;

    float at(std::size_t corner) const {
      const double x = corner % 2 == 0 ? -0.5 : 0.5;
      const double y = corner < 2 ? -0.5 : 0.5;
      return static_cast<float>(value + x * dx + y * dy + x * y * twist);
    }
  };

  void add(const Plane& x_mm, const Plane& y_mm, const Plane& margin_mm, const Plane& gain) {
    const auto i = static_cast<std::size_t>(batch.count++);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      batch.x_mm.at[corner][i] = batch.stripes_mm.at[corner][i] = x_mm.at(corner);
      batch.y_mm.at[corner][i] = y_mm.at(corner);
      batch.margin_mm.at[corner][i] = margin_mm.at(corner);
      batch.gain.at[corner][i] = gain.at(corner);
      hits.x_mm.push_back(x_mm.at(corner));
      hits.y_mm.push_back(y_mm.at(corner));
      hits.margin_mm.push_back(margin_mm.at(corner));
      weight.push_back(gain.at(corner));
    }
  }

  CellCorners corners(int pixel) const {
    const auto at = static_cast<std::size_t>(4 * pixel);
    return {hits, weight.data(), {at, at + 1, at + 2, at + 3}};
  }

  std::array<unsigned char, cut_kernels::kBatch> simple(cut_kernels::LinearBatch& inside) const {
    std::array<unsigned char, cut_kernels::kBatch> is_simple = {};
    cut_kernels::find_cuts(batch, kLimits, inside, is_simple.data());
    return is_simple;
  }
};

constexpr CutPixels::Plane kFull = {.value = 1.0};
constexpr CutPixels::Plane kFarInside = {.value = 50.0};

/// Around the slot's edges, around the rim, or under level stripes or edges.
CutPixels random_cuts(std::uint64_t seed) {
  Rng rng(seed, Stream::kTest, 0);
  CutPixels pixels;
  for (int i = 0; i < cut_kernels::kBatch; ++i) {
    const double side = rng.uniform() < 0.5 ? -8.0 : 8.0;
    const bool is_at_rim = rng.uniform() < 0.3;
    const CutPixels::Plane x = {.value = rng.uniform(-40.0, 40.0),
                                .dx = rng.uniform(0.6, 3.0),
                                .dy = i % 5 == 0 ? 0.0 : rng.uniform(-1.0, 1.0),
                                .twist = rng.uniform(-0.02, 0.02)};
    const CutPixels::Plane y = {.value = is_at_rim ? 30.0 : side + rng.uniform(-1.0, 1.0),
                                .dx = i % 7 == 0 ? 0.0 : rng.uniform(-1.0, 1.0),
                                .dy = rng.uniform(-2.0, 2.0),
                                .twist = rng.uniform(-0.02, 0.02)};
    const CutPixels::Plane margin = {.value = is_at_rim ? rng.uniform(-1.0, 1.0) : 20.0,
                                     .dx = rng.uniform(-1.0, 1.0),
                                     .dy = rng.uniform(-1.0, 1.0)};
    pixels.add(x, y, margin, {.value = 0.8, .dx = rng.uniform(-0.2, 0.2)});
  }
  return pixels;
}

TEST(CutKernels, GiveWhatPolygonsGive) {
  int partly = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const double duty = 0.1 + 0.02 * static_cast<double>(seed);
    const ScanPositions p = cut_positions(duty, 0.2);
    const CutPixels pixels = random_cuts(seed);
    cut_kernels::LinearBatch inside;
    cut_kernels::CutSums sums;
    const auto is_simple = pixels.simple(inside);
    cut_kernels::cut(pixels.batch, inside, p.offset_mm, 1.0 / p.period_mm, sums);
    for (std::size_t k = 0; k < p.shift_periods.size(); ++k) {
      std::array<float, cut_kernels::kBatch> found = {};
      cut_kernels::integrate(
          pixels.batch,
          sums,
          {.shift = p.shift_periods[k], .duty = p.duty, .dark = p.dark, .bright = p.bright},
          found.data());
      for (int i = 0; i < cut_kernels::kBatch; ++i) {
        const auto at = static_cast<std::size_t>(i);
        ASSERT_EQ(is_simple[at], 1) << seed << " " << i;
        CellSum sum(p);
        sum.clear();
        sum.add_smooth(pixels.corners(i), 1.0);
        // A pixel that no boundary cuts is a trapezoid there, in float.
        ASSERT_NEAR(static_cast<double>(found[at]), sum.radiance()[k], 2e-5) << seed << " " << i;
        partly += sums.area[at] > 0.01 && sums.area[at] < 0.99 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(partly, 6 * 40 * 20);
}

// A pixel of 2 x 2 mm at y = 8.5: a quarter of it lies in the slot. No stripes across it.
TEST(CutKernels, AgreeWithAnAreaByHand) {
  CutPixels pixels;
  pixels.add({.value = 3.0, .dx = 1e-7}, {.value = 8.5, .dy = 2.0}, kFarInside, kFull);
  cut_kernels::LinearBatch inside;
  cut_kernels::CutSums sums;
  EXPECT_EQ(pixels.simple(inside)[0], 1);
  cut_kernels::cut(pixels.batch, inside, 0.0, 1.0 / 12.0, sums);
  EXPECT_NEAR(sums.area[0], 0.75, 1e-6);
  float radiance = 0.0F;
  cut_kernels::integrate(pixels.batch, sums, {.duty = 0.5}, &radiance);  // x = 3 of 12 mm: bright
  EXPECT_NEAR(radiance, 0.75F, 1e-5F);
  cut_kernels::integrate(pixels.batch, sums, {.shift = 0.5, .duty = 0.5}, &radiance);
  EXPECT_NEAR(radiance, 0.0F, 1e-5F);
}

// 1 + 2 + 4 + 32 are simple of 0, 1, ..., 63.
TEST(SumSimple, LeavesOutWhatIsNotSimple) {
  std::array<float, cut_kernels::kBatch> values = {};
  std::array<unsigned char, cut_kernels::kBatch> is_simple = {};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(i);
  }
  for (const std::size_t i : {1U, 2U, 4U, 32U}) {
    is_simple[i] = 1;
  }
  EXPECT_EQ(cut_kernels::sum_simple(values.data(), is_simple.data()), 39.0F);
}

TEST(FindCuts, LeavesWhatOneLineDoesNotDescribe) {
  CutPixels pixels;
  const CutPixels::Plane middle = {.value = 0.0, .dx = 1.0};
  const CutPixels::Plane edge = {.value = 8.0, .dy = 1.0};
  pixels.add(middle, edge, kFarInside, kFull);                                      // one edge
  pixels.add(middle, {.value = 20.0}, {.value = 0.1, .dx = 1.0}, kFull);            // the rim
  pixels.add(middle, {.value = 0.0, .dy = 20.0}, kFarInside, kFull);                // both edges
  pixels.add(middle, edge, {.value = 0.1, .dx = 1.0}, kFull);                       // edge and rim
  pixels.add({.value = 100.0, .dx = 1.0}, edge, kFarInside, kFull);                 // an end
  pixels.add(middle, edge, {.value = -2.5e29, .dx = 5e29, .twist = 1e30}, kFull);   // no wall
  pixels.add(middle, {.value = 0.0, .dy = 1.0}, {.value = 0.1, .dx = 1.0}, kFull);  // rim in slot
  cut_kernels::LinearBatch inside;
  const auto is_simple = pixels.simple(inside);
  const std::vector<int> found(is_simple.begin(), is_simple.begin() + pixels.batch.count);
  EXPECT_EQ(found, (std::vector<int>{1, 1, 0, 0, 0, 0, 0}));
}

// Corners 1 mm apart, one of them off the part.
TEST(MeanGains, AreOfTheCornersOnThePartFarFromTheLightsBoundaries) {
  CutPixels pixels;
  const CutPixels::Plane x = {.value = 0.0, .dx = 1.0};
  for (const double y_mm : {20.0, 9.8, 9.2, -20.0}) {
    pixels.add(x, {.value = y_mm, .dy = 1.0}, kFarInside, {.value = 0.5, .dx = 1.0});
  }
  pixels.add(x, {.value = 20.0, .dy = 1.0}, {.value = 0.4, .dy = 0.3}, kFull);
  pixels.add(x, {.value = 20.0, .dy = 1.0}, {.value = 0.4, .dy = 0.5}, kFull);
  pixels.add({.value = 99.0, .dx = 1.0}, {.value = 20.0}, kFarInside, kFull);
  std::array<float, cut_kernels::kBatch> gain = {};
  std::array<unsigned char, cut_kernels::kBatch> is_clear = {};
  cut_kernels::mean_gains(pixels.batch, kLimits, gain.data(), is_clear.data());
  const std::vector<int> found(is_clear.begin(), is_clear.begin() + pixels.batch.count);
  // 9.8 - 1/2 - 1 >= 8 but 9.2 - 1/2 - 1 < 8; 0.4 - 0.15 against 0.3 and 0.4 - 0.25 against 0.5.
  EXPECT_EQ(found, (std::vector<int>{1, 1, 0, 1, 0, 0, 0}));
  EXPECT_FLOAT_EQ(gain[0], 1.0F);  // corners of 0 do not count
  EXPECT_FLOAT_EQ(gain[4], 1.0F);
}

}  // namespace
}  // namespace glint
