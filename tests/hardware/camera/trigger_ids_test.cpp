// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/trigger_ids.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(TriggerIds, FollowTheFirstPicture) {
  TriggerIds ids;
  ids.triggered();
  EXPECT_EQ(ids.judge(65400), FrameAge::kOfThisTrigger);
  ids.triggered();
  EXPECT_EQ(ids.judge(65400), FrameAge::kLate);
  EXPECT_EQ(ids.judge(65401), FrameAge::kOfThisTrigger);
  EXPECT_EQ(ids.judge(65402), FrameAge::kAhead);
}

// After a trigger whose picture did not come the next one has the id after its.
TEST(TriggerIds, TellTheLatePictureOfAnOlderTrigger) {
  TriggerIds ids;
  ids.triggered();
  EXPECT_EQ(ids.judge(10), FrameAge::kOfThisTrigger);
  ids.triggered();  // 11 is late
  ids.triggered();
  EXPECT_EQ(ids.judge(11), FrameAge::kLate);
  EXPECT_EQ(ids.judge(12), FrameAge::kOfThisTrigger);
}

// 65535 is followed by 1: 0 is no id.
TEST(TriggerIds, ShortIdsBeginAgainAtOne) {
  TriggerIds ids;
  ids.triggered();
  EXPECT_EQ(ids.judge(65535), FrameAge::kOfThisTrigger);
  ids.triggered();
  EXPECT_EQ(ids.judge(65535), FrameAge::kLate);
  EXPECT_EQ(ids.judge(1), FrameAge::kOfThisTrigger);
  ids.triggered();
  EXPECT_EQ(ids.judge(65535), FrameAge::kLate);
  EXPECT_EQ(ids.judge(3), FrameAge::kAhead);
}

TEST(TriggerIds, LongIdsGoOn) {
  TriggerIds ids;
  ids.triggered();
  EXPECT_EQ(ids.judge(65535), FrameAge::kOfThisTrigger);
  ids.triggered();
  EXPECT_EQ(ids.judge(65536), FrameAge::kOfThisTrigger);
  ids.triggered();
  EXPECT_EQ(ids.judge(65536), FrameAge::kLate);
  EXPECT_EQ(ids.judge(65537), FrameAge::kOfThisTrigger);
}

TEST(TriggerIds, AreUnknownWhenTheFirstPictureOfAStreamWasMissed) {
  TriggerIds ids;
  ids.triggered();
  ids.triggered();
  EXPECT_EQ(ids.judge(7), FrameAge::kAhead);
}

}  // namespace
}  // namespace glint
