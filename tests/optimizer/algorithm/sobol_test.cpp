// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/sobol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <set>

#include "core/error.h"

namespace glint {
namespace {

using Vector = std::vector<double>;

/// The plain sequence: the digital shift, which is the point of number 0, taken off again.
Vector plain_sobol_point(std::uint32_t index, int num_dimensions) {
  const Sobol shifted(7, num_dimensions);
  const Vector shift = shifted.point(0);
  Vector point = shifted.point(index);
  const auto bits_of = [](double value) { return static_cast<std::uint32_t>(value * 0x1p32); };
  for (std::size_t d = 0; d < point.size(); ++d) {
    point[d] = static_cast<double>(bits_of(point[d]) ^ bits_of(shift[d])) * 0x1p-32;
  }
  return point;
}

// Dimension 1 has directions 1/2, 1/4, 1/8; dimension 2 (polynomial x + 1) has 1/2, 3/4, 5/8;
// dimension 3 (x^2 + x + 1, first numbers 1 and 3) has 1/2, 3/4, 1/8 ^ 1/2 ^ 3/4 = 3/8 by the
// recurrence v3 = v2 ^ v1 ^ (v1 >> 2) = .110 ^ .100 ^ .001 = .011. Point i is the exclusive or of
// the directions that the bits of i ^ (i >> 1) select: 1 -> v1, 2 -> v1^v2, 3 -> v2, 4 -> v2^v3.
TEST(Sobol, FirstPointsAreAsWorkedByHand) {
  EXPECT_EQ(plain_sobol_point(1, 3), (Vector{0.5, 0.5, 0.5}));
  EXPECT_EQ(plain_sobol_point(2, 3), (Vector{0.75, 0.25, 0.25}));
  EXPECT_EQ(plain_sobol_point(3, 3), (Vector{0.25, 0.75, 0.75}));
  EXPECT_EQ(plain_sobol_point(4, 3), (Vector{0.375, 0.375, 0.625}));
}

TEST(Sobol, EveryDimensionHasOnePointInEachOf256Cells) {
  constexpr int kDimensions = 300;
  const Sobol shifted(3, kDimensions);
  std::vector<std::set<int>> cells(kDimensions);
  for (std::uint32_t i = 0; i < 256; ++i) {
    const Vector point = shifted.point(i);
    for (std::size_t d = 0; d < point.size(); ++d) {
      cells[d].insert(static_cast<int>(point[d] * 256.0));
    }
  }
  for (const std::set<int>& cell : cells) {
    EXPECT_EQ(cell.size(), 256U);
  }
}

TEST(Sobol, SeedsGiveOtherPointsAndTheSameSeedTheSame) {
  EXPECT_EQ(Sobol(1, 5).point(17), Sobol(1, 5).point(17));
  EXPECT_NE(Sobol(1, 5).point(17), Sobol(2, 5).point(17));
}

// Joe and Kuo's file gives dimension 40 the first numbers 1, 3, 1, 11, 11, 11, 77, 249. Direction k
// is the k-th of them over 2^k, and point 2^k - 1, whose Gray code is 2^(k-1), is direction k
// alone.
TEST(Sobol, HasTheDirectionNumbersOfJoeAndKuo) {
  const std::vector<int> first = {1, 3, 1, 11, 11, 11, 77, 249};
  for (int k = 1; k <= 8; ++k) {
    const double direction = first[static_cast<std::size_t>(k - 1)] / std::exp2(k);
    EXPECT_EQ(plain_sobol_point((1U << k) - 1, 40).back(), direction) << k;
  }
}

TEST(Sobol, HasAsManyDimensionsAsItsTable) {
  const Vector point = Sobol(1, kMaxSobolDimension).point(3);
  ASSERT_EQ(point.size(), std::size_t{kMaxSobolDimension});
  EXPECT_THAT(point, testing::Each(testing::AllOf(testing::Ge(0.0), testing::Lt(1.0))));
  EXPECT_NE(point, Sobol(1, kMaxSobolDimension).point(4));
  EXPECT_TRUE(Sobol(1, 0).point(3).empty());
  EXPECT_THROW(Sobol(1, kMaxSobolDimension + 1), ConfigError);
}

}  // namespace
}  // namespace glint
