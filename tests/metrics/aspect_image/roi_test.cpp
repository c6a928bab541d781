// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/roi.h"

#include <gmock/gmock.h>

#include "core/rng.h"
#include "tests/metrics/aspect_image/disc_view.h"

namespace glint {
namespace {

/// A rectangle [left, right) x [top, bottom) wholly covered.
ImageF covered_rectangle(int width_px, int height_px, int left, int top, int right, int bottom) {
  ImageF coverage(width_px, height_px);
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      coverage(x, y) = 1.0f;
    }
  }
  return coverage;
}

bool all_inside(const Mask& mask, int x, int y, int rim_px) {
  for (int v = y - rim_px; v <= y + rim_px; ++v) {
    for (int u = x - rim_px; u <= x + rim_px; ++u) {
      if (u < 0 || v < 0 || u >= mask.width() || v >= mask.height() || mask(u, v) == 0) {
        return false;
      }
    }
  }
  return true;
}

TEST(WholePixels, LeaveOutPixelsThatArePartlyOnThePart) {
  ImageF coverage(3, 1);
  coverage.values() = {1.0f, 0.99f, 0.0f};
  EXPECT_EQ(whole_pixels(coverage).values(), (Mask::Values{1, 0, 0}));
}

// Columns 1-8 and rows 1-6 less 2 on each side: columns 3-6, rows 3-4, 4 x 2 = 8 pixels.
TEST(Eroded, TakesTwoPixelsOffAHandWorkedRectangle) {
  const Mask mask = eroded(whole_pixels(covered_rectangle(10, 8, 1, 1, 9, 7)), 2);
  EXPECT_EQ(count_inside(mask), 8U);
  EXPECT_EQ(mask(3, 3), 1);
  EXPECT_EQ(mask(6, 4), 1);
  EXPECT_EQ(mask(2, 3), 0);
  EXPECT_EQ(mask(3, 2), 0);
}

TEST(Eroded, CountsBeyondTheImageAsOutside) {
  EXPECT_EQ(count_inside(eroded(Mask(9, 7, 1), 2)), 5U * 3U);
  EXPECT_EQ(count_inside(eroded(Mask(9, 7, 1), 4)), 0U);
  EXPECT_EQ(eroded(Mask(9, 7, 1), 0), Mask(9, 7, 1));
}

TEST(Eroded, KeepsExactlyThePixelsWhoseSquareIsInside) {
  Rng rng(1, Stream::kTest, 0);
  for (int trial = 0; trial < 1000; ++trial) {
    Mask mask(1 + static_cast<int>(rng.next_u32() % 14), 1 + static_cast<int>(rng.next_u32() % 14));
    for (unsigned char& value : mask.values()) {
      value = rng.uniform() < 0.93 ? 1 : 0;
    }
    const int rim_px = static_cast<int>(rng.next_u32() % 4);
    const Mask result = eroded(mask, rim_px);
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width(); ++x) {
        ASSERT_EQ(result(x, y) != 0, all_inside(mask, x, y, rim_px)) << trial;
      }
    }
  }
}

// Two radii of 1.5 px around a pixel centre hold the 29 lattice points with i^2 + j^2 <= 9.
TEST(RegionOfInterest, LeavesOutTwoRadiiAroundADefect) {
  const ImageF coverage(41, 31, 1.0f);
  const std::vector<DefectView> dents = {disc_view("dent", 20.5, 15.5, 1.5, 41, 31)};
  const Mask region = region_of_interest(coverage, dents);
  EXPECT_EQ(count_inside(region), 37U * 27U - 29U);
  EXPECT_EQ(region(20, 15), 0);
  EXPECT_EQ(region(23, 15), 0);
  EXPECT_EQ(region(24, 15), 1);
}

TEST(RegionOfInterest, RefusesToBeEmpty) {
  using ::testing::HasSubstr;
  EXPECT_THAT([] { region_of_interest(ImageF(20, 20, 0.5f), {}); },
              ::testing::ThrowsMessage<ConfigError>(
                  HasSubstr("camera.object_pixel_mm: no pixel lies wholly")));
  EXPECT_THAT([] { region_of_interest(ImageF(4, 4, 1.0f), {}); },
              ::testing::ThrowsMessage<ConfigError>(
                  HasSubstr("metrics.erosion_px: no pixel is left of 16")));
}

}  // namespace
}  // namespace glint
