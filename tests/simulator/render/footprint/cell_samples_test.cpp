// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/cell_samples.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

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

class CellsOfAPixel : public ::testing::TestWithParam<int> {};

TEST_P(CellsOfAPixel, AreSampledOneByOne) {
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

TEST_P(CellsOfAPixel, LeaveAQuarterOfThoseNotSmoothToEachCorner) {
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
TEST_P(CellsOfAPixel, LieWithinTheLimitsOfTheirPlacesWithWeight) {
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

INSTANTIATE_TEST_SUITE_P(PerAxis, CellsOfAPixel, ::testing::Values(2, 4, 8, 16));

}  // namespace
}  // namespace glint
