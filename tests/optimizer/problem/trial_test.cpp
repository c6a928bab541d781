// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/problem/trial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const Remark kPixels = {.count = 71, .text = "pixels at outlines are held"};
const Remark kEdge = {.count = {}, .text = "the edge of what the wall hides is held: no term"};

TEST(Remark, IsToldWithItsCountInFront) {
  EXPECT_EQ(text_of(kPixels), "71 pixels at outlines are held");
  EXPECT_EQ(text_of(kEdge), kEdge.text);
  const std::vector<Remark> both = {kPixels, kEdge};
  EXPECT_EQ(text_of(both), "71 pixels at outlines are held | " + kEdge.text);
  EXPECT_EQ(text_of(std::vector<Remark>{}), "");
}

TEST(Remark, IsReadFromTheTextThatEarlierVersionsKept) {
  const std::vector<Remark> both = {kPixels, kEdge};
  EXPECT_EQ(remarks_from_text(text_of(both)), both);
  EXPECT_THAT(remarks_from_text(""), IsEmpty());
  EXPECT_THAT(remarks_from_text("-3 is none"),
              ElementsAre(Remark{.count = {}, .text = "-3 is none"}));
  EXPECT_THAT(remarks_from_text("12"), ElementsAre(Remark{.count = 12, .text = ""}));
}

}  // namespace
}  // namespace glint
