// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/median.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(Median, IsTheMiddleValue) {
  EXPECT_EQ(median({7.0}), 7.0);
  EXPECT_EQ(median({9.0, 1.0, 4.0}), 4.0);
  EXPECT_EQ(median({5.0, -3.0, 8.0, 0.0, 5.0}), 5.0);
}

TEST(Median, OfAnEvenNumberIsTheMeanOfTheTwoInTheMiddle) {
  EXPECT_EQ(median({1.0, 0.0}), 0.5);
  EXPECT_EQ(median({8.0, 1.0, 4.0, 2.0}), 3.0);
}

TEST(Median, OfNothingIsAFault) {
  EXPECT_DEATH(median({}), "values to take the median of");
}

}  // namespace
}  // namespace glint
