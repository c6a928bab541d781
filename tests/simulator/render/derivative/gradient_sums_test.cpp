// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sums of a derivative that run over lanes, against the plain way.
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/render/derivative/scan_gradient.h"
#include "simulator/render/derivative/table_kernels.h"
#include "simulator/render/derivative/vertex_sums.h"
#include "simulator/render/scan/clipped_mean.h"

namespace glint::gradient_kernels {
namespace {

/// What one frame adds: the wave less its mean, its integrals of mean 0 over a period, and what
/// they change with the duty, written down piece by piece.
VertexSums frame_at(double moved, double duty) {
  const double f = moved - std::floor(moved);
  const double rest = 1.0 - duty;
  const double mean = 0.5 * duty * rest;
  if (f < duty) {
    return {.wave = rest,
            .first = rest * f - mean,
            .second = (0.5 * rest * f - mean) * f,
            .first_by_duty = -f - (0.5 - duty),
            .second_by_duty = (-0.5 * f - (0.5 - duty)) * f};
  }
  const double e = 1.0 - f;
  return {.wave = -duty,
          .first = duty * e - mean,
          .second = -(0.5 * duty * e - mean) * e,
          .first_by_duty = e - (0.5 - duty),
          .second_by_duty = -(0.5 * e - (0.5 - duty)) * e};
}

// Frames that fill no vector, one, or some and a part; phases of either sign.
TEST(WeighVertices, IsTheSumFrameByFrame) {
  for (const int frames : {1, 7, 8, 9, 24, 37}) {
    for (const double duty : {0.11, 0.5, 0.83}) {
      Rng rng(141, Stream::kTest, static_cast<std::uint64_t>(frames));
      std::vector<double> shift, weight;
      for (int k = 0; k < frames; ++k) {
        shift.push_back(rng.uniform(-1.0, 3.0));
        weight.push_back(rng.uniform(-1.0, 1.0));
      }
      const std::array<double, 5> phases = {-17.3, -0.2, 0.0, 0.45, 901.7};
      std::array<VertexSums, 5> sums;
      const double total =
          weigh_vertices(phases.data(), 5, shift.data(), weight.data(), frames, duty, sums.data());
      EXPECT_NEAR(total, std::accumulate(weight.begin(), weight.end(), 0.0), 1e-13);
      for (std::size_t i = 0; i < phases.size(); ++i) {
        VertexSums expected;
        for (std::size_t k = 0; k < shift.size(); ++k) {
          const VertexSums frame = frame_at(phases[i] - shift[k], duty);
          expected.wave += weight[k] * frame.wave;
          expected.first += weight[k] * frame.first;
          expected.second += weight[k] * frame.second;
          expected.first_by_duty += weight[k] * frame.first_by_duty;
          expected.second_by_duty += weight[k] * frame.second_by_duty;
        }
        constexpr double kExact = 1e-11;  // 900 periods away a double has steps of 1e-13
        EXPECT_NEAR(sums[i].wave, expected.wave, kExact);
        EXPECT_NEAR(sums[i].first, expected.first, kExact);
        EXPECT_NEAR(sums[i].second, expected.second, kExact);
        EXPECT_NEAR(sums[i].first_by_duty, expected.first_by_duty, kExact);
        EXPECT_NEAR(sums[i].second_by_duty, expected.second_by_duty, kExact);
      }
    }
  }
}

TEST(TotalsOf, AddEachOfTheFiveInDouble) {
  std::vector<float> v, gx, gy, duty, dark;
  for (int i = 0; i < 32; ++i) {
    const auto at = static_cast<float>(i);
    v.push_back(at);
    gx.push_back(2.0F * at);
    gy.push_back(-at);
    duty.push_back(i == 5 ? 16777216.0F : 1.0F);  // 2^24: a float cannot take one more
    dark.push_back(i == 31 ? 3.0F : 0.0F);
  }
  const BoxSums sums = totals_of(
      {.v = v.data(), .gx = gx.data(), .gy = gy.data(), .duty = duty.data(), .dark = dark.data()},
      32);
  EXPECT_EQ(sums.v, 496.0);
  EXPECT_EQ(sums.gx, 992.0);
  EXPECT_EQ(sums.gy, -496.0);
  EXPECT_EQ(sums.duty, 16777247.0);
  EXPECT_EQ(sums.dark, 3.0);
}

/// A row of pixels whose widths are those of their corners.
struct RandomRow {
  static constexpr double kScale = 1.7;
  std::vector<unsigned char> by_table;
  std::vector<float> derivative, w, top, bottom;

  /// @param steepness  of the corners: how many of the table's pieces neighbours lie apart
  RandomRow(int count, double steepness) {
    for (int i = 0; i <= count; ++i) {
      Rng rng(142, Stream::kTest, static_cast<std::uint64_t>(i));
      top.push_back(static_cast<float>(0.2 * i + rng.uniform(0.0, steepness)));
      bottom.push_back(static_cast<float>(0.2 * i + 0.1 + rng.uniform(0.0, steepness)));
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      Rng rng(143, Stream::kTest, i);
      const bool is_dark_chunk = i / 32 == 2;
      by_table.push_back(is_dark_chunk || rng.uniform() < 0.2 ? 0 : 1);
      derivative.push_back(static_cast<float>(rng.uniform(-1.0, 1.0)));
      w.push_back(static_cast<float>(std::sqrt(kScale) * std::hypot(gx(i), gy(i))));
      if (by_table.back() == 0) {
        derivative.back() = std::numeric_limits<float>::quiet_NaN();  // nobody may look at it
      }
    }
  }

  double gx(std::size_t i) const {
    return 0.5 * static_cast<double>((top[i + 1] + bottom[i + 1]) - (top[i] + bottom[i]));
  }

  double gy(std::size_t i) const {
    return 0.5 * static_cast<double>((bottom[i] + bottom[i + 1]) - (top[i] + top[i + 1]));
  }
};

// Even rows share a piece or two of the table, steep ones are strewn over it; 203 pixels are six
// chunks and a part.
TEST(TableGradient, AreThoseOfClippedMeanPixelByPixel) {
  const ClippedMean table({.gain = 2.0, .full_well_e = 10000.0}, {.duty = 0.4});
  const ClippedMean other({.gain = 3.0, .full_well_e = 10000.0}, {.duty = 0.3});
  constexpr auto kPerUnit = static_cast<float>(ClippedMean::kIntervals / ClippedMean::kWidest);
  for (const double steepness : {1e-3, 0.4}) {
    const RandomRow row(203, steepness);
    std::vector<float> by_gx(203), by_gy(203);
    double sum = 5.0;
    const double by_gradient =
        table_gradient({.by_table = row.by_table.data(),
                        .derivative = row.derivative.data(),
                        .w = row.w.data(),
                        .corners = {.top = row.top.data(), .bottom = row.bottom.data()},
                        .count = 203,
                        .scale = static_cast<float>(RandomRow::kScale)},
                       {.coefficients = table.coefficients().data(),
                        .count = ClippedMean::kIntervals,
                        .per_unit = kPerUnit},
                       {other.coefficients().data()},
                       &sum,
                       by_gx.data(),
                       by_gy.data());
    double expected_sum = 5.0;
    double expected_gradient = 0.0;
    for (std::size_t i = 0; i < row.w.size(); ++i) {
      const auto w = static_cast<double>(row.w[i]);
      const double derivative = row.by_table[i] != 0 ? static_cast<double>(row.derivative[i]) : 0.0;
      const double factor = derivative * table.mean(w) * RandomRow::kScale / w;
      ASSERT_NEAR(static_cast<double>(by_gx[i]), factor * row.gx(i), 1e-5) << i;
      ASSERT_NEAR(static_cast<double>(by_gy[i]), factor * row.gy(i), 1e-5) << i;
      expected_sum += derivative * other.mean(w);
      expected_gradient += factor * (row.gx(i) * row.gx(i) + row.gy(i) * row.gy(i));
    }
    EXPECT_NEAR(sum, expected_sum, 1e-4);
    EXPECT_NEAR(by_gradient, expected_gradient, 1e-4);
  }
}

// Five rows of three rays, the second and third open: runs of 1, 2 and 2 rows.
TEST(GradientByHits, RunsAreRowsThatAreAlike) {
  GradientByHits gradient;
  gradient.resize(5, 3);
  gradient.open(1);
  gradient.y[4] = 7.0F;
  gradient.open(1);
  gradient.open(2);
  std::vector<std::pair<std::size_t, int>> runs;
  gradient.for_each_run([&](std::size_t first, int count, const HitGradient& run) {
    runs.emplace_back(first, count);
    EXPECT_EQ(run.x, gradient.x.data() + first);
    EXPECT_EQ(run.y != nullptr, first == 3);
    EXPECT_EQ(run.margin != nullptr, first == 3);
  });
  const std::vector<std::pair<std::size_t, int>> expected = {{0, 3}, {3, 6}, {9, 6}};
  EXPECT_EQ(runs, expected);
  EXPECT_EQ(gradient.y[4], 7.0F);
  EXPECT_EQ(gradient.y[5], 0.0F);
  EXPECT_EQ(gradient.margin[8], 0.0F);
}

}  // namespace
}  // namespace glint::gradient_kernels
