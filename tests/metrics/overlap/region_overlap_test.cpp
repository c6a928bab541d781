// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/region_overlap.h"

#include <algorithm>

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

/// A region of 20 x 15 px from (left, top) on, in a picture of 40 x 30; beside it half a column
/// more.
ImageF covered(int left, int top) {
  ImageF shares(40, 30);
  for (int y = top; y < top + 15; ++y) {
    for (int x = left; x < left + 20; ++x) {
      shares(x, y) = 1.0F;
    }
    shares(left + 20, y) = 0.5F;
  }
  return shares;
}

// Regions 4 px apart have 16 x 15 whole pixels in common; moved onto each other all 20 x 15, which
// stay where `own` has them.
TEST(RegionOverlap, HasPixelsThatAreWhollyOnBoth) {
  const ImageF own = covered(5, 5);
  const ImageF other = covered(9, 5);
  const Mask there = pixels_on_both(own, other);
  EXPECT_EQ(std::ranges::count(there.values(), 1), 16 * 15);
  EXPECT_EQ(there(9, 5), 1);
  EXPECT_EQ(there(8, 5), 0);
  EXPECT_EQ(there(25, 5), 0) << "half of it is covered";
  Eigen::Affine2d to_other = Eigen::Affine2d::Identity();
  to_other.translation() = Eigen::Vector2d(4.0, 0.0);
  const Mask moved = pixels_on_both(own, other, to_other);
  EXPECT_EQ(std::ranges::count(moved.values(), 1), 20 * 15);
  EXPECT_EQ(moved(5, 5), 1);
}

// 7 x 15 = 105 pixels are enough, 6 x 15 = 90 are not; a side without a silhouette has none.
TEST(RegionOverlap, HasNoPixelsOnBothWhereTheyAreFew) {
  EXPECT_FALSE(pixels_on_both(covered(5, 5), covered(18, 5)).empty());
  EXPECT_TRUE(pixels_on_both(covered(5, 5), covered(19, 5)).empty());
  EXPECT_TRUE(pixels_on_both(covered(5, 5), ImageF()).empty());
  EXPECT_TRUE(pixels_on_both(ImageF(), covered(5, 5)).empty());
}

TEST(RegionOverlap, RefusesDifferentSizes) {
  EXPECT_THROW(overlap_of(Mask(3, 3), Mask(3, 4)), ConfigError);
}

}  // namespace
}  // namespace glint
