// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/path_tracing/sobol.h"

#include <set>

#include <gtest/gtest.h>

namespace glint {
namespace {

/// By its direction numbers v(k + 1) = v(k) xor v(k) / 2.
std::uint32_t second_sobol_by_sum(std::uint32_t index) {
  std::uint32_t y = 0;
  for (std::uint32_t v = 1U << 31U; index != 0; index >>= 1U, v ^= v >> 1U) {
    y ^= (index & 1U) != 0 ? v : 0U;
  }
  return y;
}

/// Whether 2^m samples put exactly one into each of the 2^m boxes of every elementary shape.
bool is_net(std::uint32_t seed, std::uint32_t dimension, unsigned m, std::uint32_t first) {
  const std::uint32_t count = 1U << m;
  for (unsigned columns = 0; columns <= m; ++columns) {
    std::set<std::pair<int, int>> boxes;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto at = SobolSampler{.seed = seed, .index = first + i}.pair(dimension);
      boxes.emplace(static_cast<int>(at[0] * (1U << columns)),
                    static_cast<int>(at[1] * (1U << (m - columns))));
    }
    if (boxes.size() != count) {
      return false;
    }
  }
  return true;
}

TEST(Sobol, SecondDimensionIsThatOfItsDirectionNumbers) {
  for (std::uint32_t i = 0; i < 4096; ++i) {
    const std::uint32_t index = i * 2654435761U;
    ASSERT_EQ(reversed_bits(second_sobol_reversed(index)), second_sobol_by_sum(index)) << index;
  }
}

TEST(SobolSampler, AlignedRunsOfAnyPairAreNets) {
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    ASSERT_TRUE(is_net(hash_bits(seed), seed % 7, 4, 16 * (seed % 5))) << seed;
    ASSERT_TRUE(is_net(hash_bits(seed), 3, 6, 0)) << seed;
  }
}

TEST(SobolSampler, RunsThatAreNotAlignedAreNoNets) {
  EXPECT_FALSE(is_net(1U, 0, 6, 7));
}

TEST(SobolSampler, PairsOfDifferentDimensionsAndPixelsAreUncorrelated) {
  constexpr int kCount = 4096;
  double across_dimensions = 0.0;
  double across_pixels = 0.0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const SobolSampler numbers = {.seed = pixel_seed(i, 1), .index = 0};
    const SobolSampler next = {.seed = pixel_seed(i + 1, 1), .index = 0};
    const double x = numbers.pair(0)[0] - 0.5;
    across_dimensions += x * (numbers.pair(1)[0] - 0.5) / kCount;
    across_pixels += x * (next.pair(0)[0] - 0.5) / kCount;
  }
  // Standard deviation of either: (1 / 12) / sqrt(4096) = 0.0013.
  EXPECT_NEAR(across_dimensions, 0.0, 0.0065);
  EXPECT_NEAR(across_pixels, 0.0, 0.0065);
}

}  // namespace
}  // namespace glint
