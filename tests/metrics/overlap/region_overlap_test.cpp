// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/region_overlap.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace glint {
namespace {

Mask square(int left, int top, int size) {
  Mask mask(10, 8);
  for (int y = top; y < top + size; ++y) {
    for (int x = left; x < left + size; ++x) {
      mask(x, y) = 1;
    }
  }
  return mask;
}

// Squares of 4 x 4 a column apart: 12 pixels in common, 20 in either: 12 / 20 and 24 / 32.
TEST(RegionOverlap, OfTwoSquaresIsWhatOneCounts) {
  const RegionOverlap overlap = overlap_of(square(1, 1, 4), square(2, 1, 4));
  EXPECT_DOUBLE_EQ(overlap.iou, 0.6);
  EXPECT_DOUBLE_EQ(overlap.dice, 0.75);
  EXPECT_DOUBLE_EQ(overlap.first_px, 16.0);
}

// One row of pixels, 2.5 and 2.25 of them covered: 2.25 / 2.5.
TEST(RegionOverlap, OfSharesIsThatOfTheOutlines) {
  ImageF first(4, 1);
  ImageF second(4, 1);
  first.values() = {1.0F, 1.0F, 0.5F, 0.0F};
  second.values() = {1.0F, 1.0F, 0.25F, 0.0F};
  EXPECT_DOUBLE_EQ(overlap_of(first, second).iou, 0.9);
}

TEST(RegionOverlap, OfNothingAndNothingIsWhole) {
  EXPECT_EQ(overlap_of(Mask(3, 3), Mask(3, 3)).iou, 1.0);
  EXPECT_EQ(overlap_of(square(0, 0, 2), Mask(10, 8)).iou, 0.0);
}

TEST(RegionOverlap, RefusesDifferentSizes) {
  EXPECT_THROW(overlap_of(Mask(3, 3), Mask(3, 4)), ConfigError);
}

}  // namespace
}  // namespace glint
