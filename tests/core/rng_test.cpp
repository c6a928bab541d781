// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/rng.h"

#include <array>
#include <cmath>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

using Words = std::array<std::uint32_t, 4>;

// The known-answer vectors of Random123 for philox4x32-10.
TEST(Philox, GivesThePublishedKnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t kOnes = 0xffffffff;
  EXPECT_EQ(philox({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// Counter (block, stream, low index, high index), key (low seed, high seed).
TEST(Rng, DrawsTheWordsOfItsCounter) {
  Rng rng(0x1122334455667788, Stream::kTest, 0x99aabbccddeeff00);
  for (std::uint32_t block = 0; block < 3; ++block) {
    const Words expected =
        philox({block, static_cast<std::uint32_t>(Stream::kTest), 0xddeeff00, 0x99aabbcc},
               {0x55667788, 0x11223344});
    for (const std::uint32_t word : expected) {
      EXPECT_EQ(rng.next_u32(), word);
    }
  }
}

TEST(Rng, UniformIsMadeOf53Bits) {
  Rng words(5, Stream::kTest, 6);
  Rng numbers(5, Stream::kTest, 6);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t high = words.next_u32() >> 5;
    const std::uint64_t low = words.next_u32() >> 6;
    const double expected = static_cast<double>(high * (1ULL << 26) + low) / std::pow(2.0, 53);
    ASSERT_EQ(numbers.uniform(), expected);
  }
}

// Uniform: mean 1/2, variance 1/12, standard error of the mean sqrt(1/12/n) = 6.5e-4 for 2e5.
TEST(Rng, UniformHasItsMomentsAndStaysInRange) {
  constexpr int kCount = 200000;
  Rng rng(7, Stream::kTest, 0);
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double value = rng.uniform();
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    sum += value;
    sum_of_squares += value * value;
  }
  const double mean = sum / kCount;
  EXPECT_NEAR(mean, 0.5, 4 * 6.5e-4);
  EXPECT_NEAR(sum_of_squares / kCount - mean * mean, 1.0 / 12.0, 1e-3);
}

// Normal: moments 0, 1, 0, 3 with standard errors sqrt(1, 2, 15, 96) / sqrt(n); 4 sigma below.
TEST(Rng, NormalHasItsFirstFourMoments) {
  constexpr int kCount = 200000;
  Rng rng(8, Stream::kTest, 0);
  std::array<double, 5> moments = {};
  for (int i = 0; i < kCount; ++i) {
    const double value = rng.normal();
    for (std::size_t k = 1; k < moments.size(); ++k) {
      moments[k] += std::pow(value, static_cast<double>(k)) / kCount;
    }
  }
  const double root = std::sqrt(static_cast<double>(kCount));
  EXPECT_NEAR(moments[1], 0.0, 4 * 1.0 / root);
  EXPECT_NEAR(moments[2], 1.0, 4 * std::sqrt(2.0) / root);
  EXPECT_NEAR(moments[3], 0.0, 4 * std::sqrt(15.0) / root);
  EXPECT_NEAR(moments[4], 3.0, 4 * std::sqrt(96.0) / root);
}

// 64 bins of 20,000 draws: chi-square with 63 degrees of freedom has mean 63, deviation 11.2.
TEST(Rng, UniformFillsItsRangeEvenlyOverNeighbouringIndices) {
  std::array<double, 64> bins = {};
  constexpr int kCount = 20000;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    Rng rng(9, Stream::kTest, i);
    bins[static_cast<std::size_t>(rng.uniform() * 64.0)] += 1.0;
  }
  double chi_square = 0.0;
  for (const double bin : bins) {
    const double expected = kCount / 64.0;
    chi_square += (bin - expected) * (bin - expected) / expected;
  }
  EXPECT_LT(chi_square, 63 + 5 * 11.2);
  EXPECT_GT(chi_square, 63 - 5 * 11.2);
}

TEST(Rng, NumbersOfAnIndexDoNotDependOnTheOrderOfVisits) {
  constexpr std::size_t kCount = 1000;
  std::vector<double> forward(kCount);
  std::vector<double> backward(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    Rng rng(3, Stream::kShotNoise, i);
    forward[i] = rng.normal();
  }
  for (std::size_t i = kCount; i-- > 0;) {
    Rng other(3, Stream::kReadNoise, i);
    other.normal();
    Rng rng(3, Stream::kShotNoise, i);
    backward[i] = rng.normal();
  }
  EXPECT_EQ(forward, backward);
}

TEST(Rng, SeedStreamAndIndexEachChangeTheNumbers) {
  std::set<std::uint32_t> first_words;
  for (const std::uint64_t seed : {1ULL, 2ULL, 1ULL << 32}) {
    for (const Stream stream : {Stream::kShotNoise, Stream::kSearch}) {
      for (const std::uint64_t index : {0ULL, 1ULL, 1ULL << 32}) {
        first_words.insert(Rng(seed, stream, index).next_u32());
      }
    }
  }
  EXPECT_EQ(first_words.size(), 18U);
}

TEST(Rng, UniformBetweenBoundsStaysBetweenThem) {
  Rng rng(4, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const double value = rng.uniform(-2.0, 3.0);
    ASSERT_GE(value, -2.0);
    ASSERT_LT(value, 3.0);
  }
}

}  // namespace
}  // namespace glint
