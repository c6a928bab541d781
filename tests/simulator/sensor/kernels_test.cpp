// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/rng.h"
#include "simulator/sensor/sensor_kernels.h"

namespace glint {
namespace {

/// Standard normal quantile by bisection on std::erfc, for u <= 1/2.
double lower_quantile_by_bisection(double u) {
  double low = -10.0;
  double high = 0.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::sqrt(2.0)) < u ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

float quantile_of_word(std::uint32_t word) {
  float normal = 0.0f;
  sensor_kernels::normal_quantiles(&word, 1, &normal);
  return normal;
}

TEST(SensorKernels, PhiloxWordsAreThoseOfRng) {
  const std::uint64_t seed = 0x123456789ABCDEFULL;
  std::vector<std::uint32_t> words(40);
  sensor_kernels::philox_words(
      {.key = {0x89ABCDEF, 0x1234567}, .stream = 2, .frame = 7}, 0, 10, words.data());
  Rng rng(seed, Stream::kReadNoise, 7);
  for (const std::uint32_t word : words) {
    EXPECT_EQ(word, rng.next_u32());
  }
  std::vector<std::uint32_t> later(8);
  sensor_kernels::philox_words(
      {.key = {0x89ABCDEF, 0x1234567}, .stream = 2, .frame = 7}, 3, 2, later.data());
  EXPECT_TRUE(std::equal(later.begin(), later.end(), words.begin() + 12));
}

// Two-sided 95 %: u = 0.025 is the word 0.025 x 2^32 = 107374182.4, whose quantile is -1.959964.
TEST(SensorKernels, NormalQuantilesMatchAKnownValue) {
  EXPECT_NEAR(quantile_of_word(107374182), -1.959964, 2e-6);
  EXPECT_NEAR(quantile_of_word(0x80000000U - 0x10000000U), -0.1573107, 1e-6);  // u = 7/16
}

TEST(SensorKernels, NormalQuantilesInvertTheDistributionToAFewMillionths) {
  Rng rng(5, Stream::kTest, 0);
  for (int i = 0; i < 4000; ++i) {
    // Half of the words uniform, half pushed towards the tail.
    std::uint32_t word = rng.next_u32() >> 1;
    if (i % 2 == 1) {
      word >>= rng.next_u32() % 31;
    }
    const double exact = lower_quantile_by_bisection((word + 0.5) * 0x1p-32);
    EXPECT_NEAR(quantile_of_word(word), exact, 2e-6) << word;
    EXPECT_EQ(quantile_of_word(~word), -quantile_of_word(word)) << word;
  }
}

TEST(SensorKernels, RowsOfAnyLengthAndRadiusAreTheSameSum) {
  Rng rng(6, Stream::kTest, 1);
  for (int radius = 0; radius <= 13; ++radius) {
    const int width = 1 + static_cast<int>(rng.next_u32() % 70);
    std::vector<float> line(static_cast<std::size_t>(width + 2 * radius));
    for (float& value : line) {
      value = static_cast<float>(rng.uniform());
    }
    std::vector<float> weights;
    std::vector<const float*> low;
    std::vector<const float*> high;
    for (int k = 0; k <= radius; ++k) {
      weights.push_back(static_cast<float>(rng.uniform()));
      if (k > 0) {
        low.push_back(line.data() + radius - k);
        high.push_back(line.data() + radius + k);
      }
    }
    std::vector<float> out(static_cast<std::size_t>(width));
    sensor_kernels::weigh_rows(
        {line.data() + radius, low.data(), high.data(), weights.data(), radius}, width, out.data());
    for (int x = 0; x < width; ++x) {
      const float* at = line.data() + radius + x;
      float sum = weights[0] * at[0];
      for (int k = 1; k <= radius; ++k) {
        sum += weights[static_cast<std::size_t>(k)] * (at[-k] + at[k]);
      }
      EXPECT_EQ(out[static_cast<std::size_t>(x)], sum);
    }
  }
}

}  // namespace
}  // namespace glint
