// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/mask_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/image/grown_mask.h"
#include "core/image/spans.h"
#include "core/rng.h"

namespace glint {
namespace {

using Bytes = std::vector<unsigned char>;

/// No multiple of any vector's length.
constexpr int kMaskCount = 1003;

Bytes random_bytes(std::uint64_t index, int largest = 1) {
  Rng rng(5, Stream::kTest, index);
  Bytes mask(kMaskCount);
  for (unsigned char& value : mask) {
    value = static_cast<unsigned char>(rng.uniform(0.0, largest + 1.0));
  }
  return mask;
}

TEST(MaskKernels, SubtractPixelByPixel) {
  const Bytes a = random_bytes(1);
  const Bytes b = random_bytes(2);
  Bytes rest(a.size());
  mask_kernels::subtract(a.data(), b.data(), kMaskCount, rest.data());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(rest[i], a[i] != 0 && b[i] == 0 ? 1 : 0) << i;
  }
  EXPECT_EQ(mask_kernels::count_ones(rest.data(), kMaskCount),
            static_cast<int>(std::ranges::count(rest, 1)));
}

TEST(RowGrower, IsTheDilatedMask) {
  for (const int radius : {0, 1, 2, 5, 40}) {
    Mask mask(67, 23);
    Rng rng(5, Stream::kTest, static_cast<std::uint64_t>(radius));
    for (unsigned char& value : mask.values()) {
      value = rng.uniform() < 0.01 ? 1 : 0;
    }
    RowGrower grower(mask.width(), radius);
    Mask grown(mask.width(), mask.height());
    for (int y = 0; y < mask.height(); ++y) {
      grower.grow(mask, y, grown.row(y));
    }
    EXPECT_EQ(grown, dilated(mask, radius)) << radius;
  }
}

TEST(MaskKernels, SplitStatesIntoOtherAndLit) {
  const Bytes state = random_bytes(3, 2);
  Bytes other(state.size()), lit(state.size());
  mask_kernels::split_states(state.data(), kMaskCount, other.data(), lit.data());
  for (std::size_t i = 0; i < state.size(); ++i) {
    ASSERT_EQ(other[i], state[i] != 1 ? 1 : 0) << i;
    ASSERT_EQ(lit[i], state[i] != 0 ? 1 : 0) << i;
  }
}

// Every pixel of the region is closed, watched, rendered in frames, or dark all around.
TEST(MaskKernels, SortPixelsOfTheRegion) {
  const Bytes region = random_bytes(4);
  const Bytes watched = random_bytes(5);
  const Bytes near_other = random_bytes(6);
  const Bytes near_light = random_bytes(7);
  Bytes closed(region.size());
  Bytes frames = watched;
  mask_kernels::mark_closed(
      region.data(), watched.data(), near_other.data(), kMaskCount, closed.data());
  mask_kernels::mark_frames(
      region.data(), closed.data(), near_light.data(), kMaskCount, frames.data());
  for (std::size_t i = 0; i < region.size(); ++i) {
    ASSERT_EQ(closed[i], region[i] != 0 && watched[i] == 0 && near_other[i] == 0 ? 1 : 0) << i;
    const bool is_frame = region[i] != 0 && closed[i] == 0 && near_light[i] != 0;
    ASSERT_EQ(frames[i], watched[i] != 0 || is_frame ? 1 : 0) << i;
  }
}

TEST(MaskKernels, AddBendsAwayFromOthers) {
  const Bytes is_linear = random_bytes(8);
  const Bytes is_beside = random_bytes(9);
  const Bytes before = random_bytes(10);
  Bytes other = before;
  mask_kernels::add_bends(is_linear.data(), is_beside.data(), kMaskCount, other.data());
  for (std::size_t i = 0; i < other.size(); ++i) {
    const bool is_bent = is_linear[i] == 0 && is_beside[i] == 0;
    ASSERT_EQ(other[i], before[i] != 0 || is_bent ? 1 : 0) << i;
  }
}

TEST(MaskKernels, FindTheLargestSizeInside) {
  const Bytes mask = random_bytes(11);
  Rng rng(5, Stream::kTest, 12);
  std::vector<float> values(mask.size()), margin(mask.size());
  float expected = 0.0F;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    values[i] = static_cast<float>(rng.uniform(-9.0, 5.0));
    margin[i] = static_cast<float>(rng.uniform(-1.0, 1.0));
    if (mask[i] != 0 && margin[i] >= 0.0F) {
      expected = std::max(expected, std::abs(values[i]));
    }
  }
  EXPECT_EQ(mask_kernels::largest_size(mask.data(), values.data(), margin.data(), kMaskCount),
            expected);
  EXPECT_GT(expected, 5.0F);
}

}  // namespace
}  // namespace glint
