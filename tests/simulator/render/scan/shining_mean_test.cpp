// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan/shining_mean.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/scan/clipped_stripe.h"

namespace glint {
namespace {

/// A noiseless sensor without rounding.
SensorSettings noiseless(double gain) {
  return {.gain = gain, .bits = 0};
}

double shining_mean(double gain, double duty, double dark, double w) {
  return ShiningMean(noiseless(gain), {.duty = duty}, dark, dark).mean(w, dark);
}

// Sharp stripes, gain 2, duty 0.5: (1 + 2 * 0.21) / 2, and all at full scale for D = 0.55. Blurred
// away: 1.5 (0.21 + 0.79 * 0.25) = 0.61125.
TEST(ShiningMean, BothEndsByHand) {
  EXPECT_NEAR(shining_mean(2.0, 0.5, 0.21, 0.0), 0.71, 1e-6);
  EXPECT_NEAR(shining_mean(2.0, 0.5, 0.55, 0.0), 1.0, 1e-6);
  EXPECT_NEAR(shining_mean(1.5, 0.25, 0.21, 10.0), 0.61125, 1e-5);
  EXPECT_NEAR(shining_mean(0.9, 0.5, 0.003, 0.0), 0.45135, 1e-6);
  EXPECT_NEAR(shining_mean(0.9, 0.5, 0.999, 0.1), 0.89955, 1e-6);
}

/// Stripes and a sensor as scenes have them.
struct RandomStripes {
  double gain, duty, w, dark;

  explicit RandomStripes(std::uint64_t index) {
    Rng rng(131, Stream::kTest, index);
    gain = rng.uniform(0.95, 3.2);
    duty = rng.uniform(0.18, 0.82);
    w = 0.8 * std::pow(rng.uniform(), 2.0);
    dark = rng.uniform(0.002, 0.5);
  }
};

// Without noise the mean of one clipped stripe is exact, and its error that of the levels and of
// the widths between the nodes; the latter is that of ClippedMean, too. The rest lies where stripes
// blurred to their mean just reach full scale: a kink by D.
void expect_right(const char* where, double (*dark_of)(std::uint64_t index, double drawn)) {
  std::vector<double> errors;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    RandomStripes r(i);
    r.dark = dark_of(i, r.dark);
    const double exact =
        clipped_mean_of({.duty = r.duty, .w = r.w}, r.gain * (1.0 - r.dark), r.gain * r.dark);
    errors.push_back(std::abs(shining_mean(r.gain, r.duty, r.dark, r.w) - exact));
  }
  std::ranges::sort(errors);
  fmt::print("T(w, D) {}: 90 % within {:.1e}, 98 % within {:.1e}, all within {:.1e}\n",
             where,
             errors[1799],
             errors[1959],
             errors.back());
  EXPECT_LT(errors[1799], 1e-5);
  EXPECT_LT(errors[1959], 4e-4);
  EXPECT_LT(errors.back(), 5e-3);
}

TEST(ShiningMean, IsRightBetweenItsLevels) {
  expect_right("without noise", [](std::uint64_t, double drawn) { return drawn; });
}

// Black print and glowing print: the first and the last level have no neighbour beyond.
TEST(ShiningMean, IsRightAtBothEndsOfItsLevels) {
  expect_right("at the ends", [](std::uint64_t index, double drawn) {
    return index % 2 == 0 ? drawn / 32.0 : 1.0 - drawn / 32.0;
  });
}

// At a level the mean is that level's, the first and the last included.
TEST(ShiningMean, IsTheTablesAtTheirLevels) {
  const ShiningMean table(noiseless(2.5), {.duty = 0.35}, 0.0, 1.0);
  for (const int level : {0, 1, 2, 30, 62, 63, 64}) {
    for (const double w : {0.0, 0.07, 0.3, 0.8}) {
      EXPECT_NEAR(table.mean(w, ShiningMean::dark_of(level)), table.table(level).mean(w), 1e-6);
    }
  }
}

// Against the table of just that radiance.
TEST(ShiningMean, IsRightBetweenItsLevelsWithNoise) {
  double mean = 0.0;
  double deviation = 0.0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const RandomStripes r(i);
    const SensorSettings sensor = {
        .gain = r.gain, .bits = 0, .full_well_e = 20000.0, .read_noise_e = 8.0};
    const ShiningMean table(sensor, {.duty = r.duty}, r.dark, r.dark);
    const ClippedMean own(sensor, {.duty = r.duty, .dark = r.dark});
    mean = std::max(mean, std::abs(table.mean(r.w, r.dark) - own.mean(r.w)));
    const double spread = own.deviation(r.w);
    deviation = std::max(deviation, std::abs(table.deviation(r.w, r.dark) - spread));
  }
  fmt::print("T(w, D) with noise: {:.1e}, its deviation {:.1e}\n", mean, deviation);
  EXPECT_LT(mean, 3e-3);
  EXPECT_LT(deviation, 2e-4);
}

// Negative control: one table of the mean radiance is off by more than a point of full scale.
TEST(ShiningMean, OneRadianceForAllWouldBeNoticed) {
  EXPECT_GT(std::abs(shining_mean(2.0, 0.5, 0.11, 0.1) - shining_mean(2.0, 0.5, 0.08, 0.1)), 0.01);
}

TEST(ShiningMean, HasTheSlopesOfItsMean) {
  const ShiningMean table(noiseless(2.0), {.duty = 0.4}, 0.0, 1.0);
  for (const double dark : {0.003, 0.06, 0.1301, 0.2, 0.991}) {
    for (const double w : {0.031, 0.12, 0.3}) {
      const ShiningMean::Value at = table.value_of(table.means(), w, ShiningMean::stencil_of(dark));
      constexpr double kStep = 1e-4;
      EXPECT_DOUBLE_EQ(at.value, table.mean(w, dark));
      EXPECT_NEAR(at.by_dark,
                  (table.mean(w, dark + kStep) - table.mean(w, dark - kStep)) / (2.0 * kStep),
                  1e-4);
      EXPECT_NEAR(at.by_width,
                  (table.mean(w + kStep, dark) - table.mean(w - kStep, dark)) / (2.0 * kStep),
                  2e-3);
    }
  }
}

// Rows whose pixels share their levels, rows whose do not, and pixels that have no table.
TEST(ShiningMean, LooksUpRowsAsPixels) {
  const SensorSettings sensor = {.gain = 2.0, .full_well_e = 10000.0, .dark_e = 30.0};
  const ShiningMean table(sensor, {.duty = 0.4}, 0.0, 0.5);
  Rng rng(132, Stream::kTest, 0);
  constexpr int kCount = 75;
  for (const auto& [least, spread] : std::array<std::pair<double, double>, 4>{
           {{0.05, 0.0}, {0.05, 0.004}, {0.05, 0.4}, {0.0, 0.015}}}) {
    std::vector<unsigned char> mask;
    std::vector<float> w, dark, mean(kCount), deviation(kCount);
    for (int i = 0; i < kCount; ++i) {
      mask.push_back(rng.uniform() < 0.8 ? 1 : 0);
      w.push_back(static_cast<float>(rng.uniform(0.0, 0.9)));
      dark.push_back(static_cast<float>(least + spread * rng.uniform()));
    }
    table.look_up(mask.data(), w.data(), dark.data(), kCount, mean.data(), deviation.data());
    const ClippedMean any(sensor, {.duty = 0.4});
    for (std::size_t i = 0; i < mask.size(); ++i) {
      const auto width = static_cast<double>(w[i]);
      const auto radiance = static_cast<double>(dark[i]);
      const bool is_used = mask[i] != 0;
      EXPECT_NEAR(static_cast<double>(mean[i]),
                  is_used ? table.mean(width, radiance) : any.dark_level(),
                  2e-6);
      EXPECT_NEAR(static_cast<double>(deviation[i]),
                  is_used ? table.deviation(width, radiance) : any.dark_deviation(),
                  1e-7);
    }
  }
}

// Gain 4, sharp stripes: dark ones reach full scale from D = 0.25 on. Blurred away, duty 0.2:
// 4 (D + 0.2 (1 - D)) = 1 at D = 0.0625.
TEST(ShiningMean, KnowsWhereItIsSaturated) {
  const ShiningMean table(noiseless(4.0), {.duty = 0.2}, 0.0, 0.5);
  EXPECT_FALSE(table.is_saturated(0.0, 0.249));
  EXPECT_TRUE(table.is_saturated(0.0, 0.251));
  EXPECT_FALSE(table.is_saturated(0.79, 0.062));
  EXPECT_TRUE(table.is_saturated(0.79, 0.063));
}

}  // namespace
}  // namespace glint
