// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/stage_serving.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

// Six frames 2 mm apart, stripes of 12 mm: 5 mm along the scan are the third frame and 1 mm. The
// scan of a design with an offset of 5 mm goes on to 15 mm, which look like 3 mm.
TEST(StagePlace, IsAFrameOfTheScanAndAShiftBeyondIt) {
  const StripeScan scan = {.positions = 6, .step_mm = 2.0, .period_mm = 12.0};
  const auto at = [&](double along_mm) { return place_along(along_mm, scan); };
  EXPECT_EQ(at(5.0), (StagePlace{.position = 2, .shift_mm = 1.0}));
  EXPECT_EQ(at(11.0), (StagePlace{.position = 5, .shift_mm = 1.0}));
  EXPECT_EQ(at(15.0), (StagePlace{.position = 1, .shift_mm = 1.0}));
  EXPECT_EQ(at(-0.5), (StagePlace{.position = 5, .shift_mm = 1.5}));
  EXPECT_EQ(at(14.0), (StagePlace{.position = 1, .shift_mm = 0.0})) << "a period on";
  EXPECT_EQ(at(0.0), StagePlace{});
  EXPECT_EQ(at(5.999999999), (StagePlace{.position = 3, .shift_mm = 0.0}));
}

// A scan over half a period: 10 mm lie beyond its last frame at 4 mm.
TEST(StagePlace, IsBeyondTheLastFrameOfAShortScan) {
  const StripeScan scan = {.positions = 3, .step_mm = 2.0, .period_mm = 12.0};
  EXPECT_EQ(place_along(10.0, scan), (StagePlace{.position = 2, .shift_mm = 6.0}));
}

}  // namespace
}  // namespace glint
