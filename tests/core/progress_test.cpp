// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

TEST(DurationText, WritesMinutesAndSeconds) {
  EXPECT_EQ(duration_text(0.0), "0:00");
  EXPECT_EQ(duration_text(18.4), "0:18");
  EXPECT_EQ(duration_text(59.6), "1:00");
  EXPECT_EQ(duration_text(725.0), "12:05");
}

// 3 h 2 min 10 s = 10930 s.
TEST(DurationText, WritesHoursFromOneHourUpwards) {
  EXPECT_EQ(duration_text(3599.4), "59:59");
  EXPECT_EQ(duration_text(3600.0), "1:00:00");
  EXPECT_EQ(duration_text(10930.0), "3:02:10");
  EXPECT_EQ(duration_text(-5.0), "0:00");
}

// 12 of 30 = 40 %, 24 * 12 / 30 = 9.6 -> 9 marks; 12 steps in 12 s leave 18 steps in 18 s.
TEST(ProgressLine, ShowsAHandWorkedBar) {
  EXPECT_EQ(Progress::line("search", 12, 30, 12.0, "best 0.9"),
            "search [#########---------------] 40 % (12/30) ETA 0:18  best 0.9");
}

TEST(ProgressLine, KnowsNoEndBeforeTheFirstStepAndNoneAfterTheLast) {
  EXPECT_EQ(Progress::line("x", 0, 30, 5.0, ""), "x [------------------------] 0 % (0/30) ETA ?");
  EXPECT_EQ(Progress::line("x", 30, 30, 5.0, ""),
            "x [########################] 100 % (30/30) ETA 0:00");
}

TEST(Progress, WritesAPlainLastLineWithoutATerminal) {
  testing::internal::CaptureStderr();
  {
    Progress progress("trace", 4, Progress::Style::kLines);
    for (int i = 1; i <= 4; ++i) {
      progress.update(i, "note");
    }
  }
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_THAT(text, HasSubstr("trace [########################] 100 % (4/4) ETA 0:00  note\n"));
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

TEST(Progress, EndsItsBarWithANewLine) {
  testing::internal::CaptureStderr();
  { Progress("trace", 2, Progress::Style::kBar).update(2); }
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_THAT(text, HasSubstr("\r\x1b[Ktrace ["));
  EXPECT_THAT(text, EndsWith("(2/2) ETA 0:00\n"));
}

TEST(Progress, IsSilentWhenToldSo) {
  testing::internal::CaptureStderr();
  { Progress("trace", 2, Progress::Style::kNone).update(2); }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Progress, StaysInsideTheBarWhenMoreIsDoneThanPlanned) {
  testing::internal::CaptureStderr();
  { Progress("trace", 2, Progress::Style::kLines).update(5); }
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("100 % (2/2)"));
}

}  // namespace
}  // namespace glint
