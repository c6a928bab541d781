// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/ray_cache/seen_kernels.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "simulator/geometry/bvh/ray_packet.h"

namespace glint {
namespace {

using Doubles = std::array<double, kPacketSize>;
using Floats = std::array<float, kPacketSize>;

struct Sums {
  alignas(64) Doubles hits = {}, x_mm = {}, y_mm = {}, z_mm = {};

  SeenSums arrays() {
    return {.hits = hits.data(), .x_mm = x_mm.data(), .y_mm = y_mm.data(), .z_mm = z_mm.data()};
  }
};

struct Means {
  Floats coverage = {}, x_mm = {}, y_mm = {}, z_mm = {};
};

// Pixel 0 sees 2, nothing, 5 and 8 mm in four samples: coverage 3/4, mean (2 + 5 + 8) / 3 = 5 mm.
// Pixel 1 sees nothing. Pixel 2 is behind the last one and stays as it is.
TEST(SeenSums, GiveShareAndMeanOfWhatWasSeen) {
  Sums sums;
  constexpr int kCount = 2;
  for (const double seen_mm : {2.0, 0.0, 5.0, 8.0}) {
    alignas(64) Doubles x_mm = {}, y_mm = {}, z_mm = {}, is_seen = {};
    x_mm.fill(seen_mm);
    y_mm.fill(-seen_mm);
    z_mm.fill(10.0 * seen_mm);
    is_seen[0] = is_seen[2] = seen_mm > 0.0 ? 1.0 : 0.0;
    add_seen(x_mm.data(), y_mm.data(), z_mm.data(), is_seen.data(), kCount, sums.arrays());
  }
  Means means;
  means.coverage[2] = -1.0F;
  mean_seen(sums.arrays(),
            4,
            kCount,
            means.coverage.data(),
            means.x_mm.data(),
            means.y_mm.data(),
            means.z_mm.data());
  EXPECT_EQ(means.coverage[0], 0.75F);
  EXPECT_EQ(means.x_mm[0], 5.0F);
  EXPECT_EQ(means.y_mm[0], -5.0F);
  EXPECT_EQ(means.z_mm[0], 50.0F);
  EXPECT_EQ(means.coverage[1], 0.0F);
  EXPECT_EQ(means.x_mm[1], 0.0F);
  EXPECT_EQ(means.coverage[2], -1.0F);
}

// Lanes that see nothing are 0, also where the place they did not see is negative.
TEST(OneSeen, IsThePlaceItselfOrZeroWithoutASign) {
  alignas(64) Doubles place_mm = {}, is_seen = {};
  place_mm.fill(-3.5);
  is_seen[7] = 1.0;
  Means means;
  one_seen(place_mm.data(),
           place_mm.data(),
           place_mm.data(),
           is_seen.data(),
           kPacketSize,
           means.coverage.data(),
           means.x_mm.data(),
           means.y_mm.data(),
           means.z_mm.data());
  EXPECT_EQ(means.coverage[7], 1.0F);
  EXPECT_EQ(means.z_mm[7], -3.5F);
  EXPECT_EQ(means.coverage[8], 0.0F);
  EXPECT_EQ(means.z_mm[8], 0.0F);
  EXPECT_FALSE(std::signbit(means.z_mm[8]));
}

}  // namespace
}  // namespace glint
