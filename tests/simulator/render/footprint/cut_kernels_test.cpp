// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/cut_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/footprint/cell_sum.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

constexpr cut_kernels::CutLimits kLimits = {
    .half_slot_mm = 8.0, .x_low_mm = -100.0F, .x_high_mm = 100.0F, .nowhere_mm = -1e20F};

/// A tunnel of period 12 mm and 6 frames, its slot +-8 mm.
ScanPositions cut_positions(double duty, double dark_reflectance) {
  TunnelSettings settings = test::bench_tunnel();
  settings.duty = duty;
  settings.dark_reflectance = dark_reflectance;
  return {Tunnel(settings), {.positions = 6}};
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

/// A refined pixel: random stripes and gains at its corners, every third cell not smooth.
struct RandomCells {
  int n;
  std::vector<float> stripes_mm, gain;
  std::vector<unsigned char> is_smooth;

  explicit RandomCells(int cells_per_axis) : n(cells_per_axis) {
    Rng rng(29, Stream::kTest, static_cast<std::uint64_t>(n));
    for (int i = 0; i < (n + 1) * (n + 1); ++i) {
      stripes_mm.push_back(static_cast<float>(rng.uniform(-20.0, 20.0)));
      gain.push_back(static_cast<float>(rng.uniform()));
    }
    for (int i = 0; i < n * n; ++i) {
      is_smooth.push_back(rng.uniform() < 1.0 / 3.0 ? 0 : 1);
    }
  }

  std::array<std::size_t, 4> corners(int cell) const {
    const auto a = static_cast<std::size_t>(cell / n * (n + 1) + cell % n);
    const std::size_t b = a + static_cast<std::size_t>(n) + 1;
    return {a, a + 1, b, b + 1};
  }
};

class RefinedCells : public ::testing::TestWithParam<int> {};

TEST_P(RefinedCells, AreSampledOneByOne) {
  const RandomCells cells(GetParam());
  const std::size_t count = cells.is_smooth.size();
  std::vector<float> v(count), gx(count), gy(count), gain(count);
  const float widest_mm = cut_kernels::sample_cells({.stripes_mm = cells.stripes_mm.data(),
                                                     .gain = cells.gain.data(),
                                                     .is_smooth = cells.is_smooth.data(),
                                                     .cells_per_axis = cells.n},
                                                    3.0F,
                                                    0.125F,
                                                    {v.data(), gx.data(), gy.data(), gain.data()});
  float expected_widest_mm = 0.0F;
  for (std::size_t cell = 0; cell < count; ++cell) {
    const auto [a, b, c, d] = cells.corners(static_cast<int>(cell));
    const auto at = [&](std::size_t i) { return static_cast<double>(cells.stripes_mm[i]); };
    const bool is_used = cells.is_smooth[cell] != 0;
    const double used = is_used ? 1.0 : 0.0;
    const auto mean_gain =
        static_cast<double>(cells.gain[a] + cells.gain[b] + cells.gain[c] + cells.gain[d]) / 4.0;
    EXPECT_NEAR(v[cell], used * ((at(a) + at(b) + at(c) + at(d)) / 4.0 - 3.0) / 8.0, 1e-6);
    EXPECT_NEAR(gx[cell], used * (at(b) + at(d) - at(a) - at(c)) / 16.0, 1e-6);
    EXPECT_NEAR(gy[cell], used * (at(c) + at(d) - at(a) - at(b)) / 16.0, 1e-6);
    EXPECT_NEAR(gain[cell], used * mean_gain / static_cast<double>(count), 1e-6);
    const auto [low, high] = std::minmax(
        {cells.stripes_mm[a], cells.stripes_mm[b], cells.stripes_mm[c], cells.stripes_mm[d]});
    expected_widest_mm = std::max(expected_widest_mm, is_used ? high - low : 0.0F);
  }
  EXPECT_EQ(widest_mm, expected_widest_mm);
}

TEST_P(RefinedCells, LeaveAQuarterOfThoseNotSmoothToEachCorner) {
  const RandomCells cells(GetParam());
  std::vector<float> expected(cells.gain.size(), 0.0F), weight(cells.gain.size(), -1.0F);
  const float quarter = 0.25F / static_cast<float>(cells.n * cells.n);
  for (std::size_t cell = 0; cell < cells.is_smooth.size(); ++cell) {
    for (const std::size_t corner : cells.corners(static_cast<int>(cell))) {
      expected[corner] += cells.is_smooth[cell] == 0 ? quarter : 0.0F;
    }
  }
  cut_kernels::corner_weights(cells.is_smooth.data(), cells.n, weight.data());
  EXPECT_EQ(weight, expected);  // sums of equal powers of two: exact
}

// Counts that fill no vector, or some and a part of one.
TEST_P(RefinedCells, LieWithinTheLimitsOfTheirPlacesWithWeight) {
  const RandomCells cells(GetParam());
  Rng rng(31, Stream::kTest, 0);
  std::vector<float> y_mm, margin_mm, weight;
  for (std::size_t i = 0; i < cells.gain.size(); ++i) {
    y_mm.push_back(static_cast<float>(rng.uniform(-90.0, -30.0)));
    margin_mm.push_back(static_cast<float>(rng.uniform(-5.0, 50.0)));
    weight.push_back(i % 4 == 3 ? 0.0F : 0.5F);
  }
  const cut_kernels::PlaceLimits limits = cut_kernels::find_limits(cells.stripes_mm.data(),
                                                                   y_mm.data(),
                                                                   margin_mm.data(),
                                                                   weight.data(),
                                                                   static_cast<int>(weight.size()));
  const auto of = [&](const std::vector<float>& values) {
    std::vector<float> seen;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (weight[i] > 0.0F) {
        seen.push_back(values[i]);
      }
    }
    const auto [low, high] = std::ranges::minmax(seen);
    return std::pair(low, high);
  };
  EXPECT_EQ(std::pair(limits.x_low_mm, limits.x_high_mm), of(cells.stripes_mm));
  EXPECT_EQ(std::pair(limits.y_low_mm, limits.y_high_mm), of(y_mm));
  EXPECT_EQ(limits.margin_low_mm, of(margin_mm).first);
}

INSTANTIATE_TEST_SUITE_P(PerAxis, RefinedCells, ::testing::Values(2, 4, 8, 16));

}  // namespace
}  // namespace glint
