// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/sensor_calibration/sensor_levels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(ReadLevels, TakesTheFormOfTheReferenceData) {
  const auto levels = parse_levels_txt(
      "v 4.0\n# comment\nb 40000.0 120.0\ni images\\a.png\ni images/b.png\n\nd 40000.0\r\n"
      "i c.png\ni d.png\n",
      "set/levels.txt");
  ASSERT_EQ(levels.size(), 2U);
  EXPECT_FALSE(levels[0].is_dark);
  EXPECT_EQ(levels[0].exposure, 40000.0);
  EXPECT_EQ(levels[0].photons, 120.0);
  EXPECT_EQ(levels[0].pictures[0], "set/images/a.png");
  EXPECT_TRUE(levels[1].is_dark);
  EXPECT_EQ(levels[1].photons, 0.0);
  EXPECT_EQ(levels[1].pictures[1], "set/d.png");
}

TEST(ReadLevels, GathersTheRowsOfATable) {
  const auto levels = parse_levels_csv(
      "file,kind,exposure\na.png,bright,5\nb.png,dark,5\nc.png,bright,5\nd.png,dark,5\n",
      "set/levels.csv");
  ASSERT_EQ(levels.size(), 2U);
  EXPECT_EQ(levels[0].pictures.size(), 2U);
  EXPECT_EQ(levels[0].pictures[1], "set/c.png");
  EXPECT_TRUE(levels[1].is_dark);
}

TEST(ReadLevels, TellWhereTheyAreWrong) {
  const auto txt = [](const char* text) { return [text] { parse_levels_txt(text, "l.txt"); }; };
  const auto csv = [](const char* text) { return [text] { parse_levels_csv(text, "l.csv"); }; };
  EXPECT_THAT(txt("b x\n"), ThrowsMessage<ConfigError>(HasSubstr("l.txt:1: 'x' must be a number")));
  EXPECT_THAT(txt("i a.png\n"), ThrowsMessage<ConfigError>(HasSubstr("must follow a level")));
  EXPECT_THAT(txt("b 5 1\ni a.png\n"), ThrowsMessage<ConfigError>(HasSubstr("has 1 picture;")));
  EXPECT_THAT(txt("\n"), ThrowsMessage<ConfigError>(HasSubstr("has no levels")));
  EXPECT_THAT(csv("file,kind,exposure\na.png,grey,5\n"),
              ThrowsMessage<ConfigError>(HasSubstr("l.csv:2:7: kind: is 'grey', must be bright")));
  EXPECT_THAT(csv("file,kind,exposure\na.png,dark,nan\n"),
              ThrowsMessage<ConfigError>(HasSubstr("l.csv:2:12: exposure: must be a number >= 0")));
  EXPECT_THAT(
      csv("file,kind,exposure\na.png,bright,5\nb.png,bright,5\nb.png,bright,6\n"),
      ThrowsMessage<ConfigError>(HasSubstr("l.csv:4:1: file: b.png is listed in line 3 already")));
  EXPECT_THAT(
      txt("b 5 1\ni p/a.png\ni p\\a.png\n"),
      ThrowsMessage<ConfigError>(HasSubstr("l.txt:3: file: a.png is listed in line 2 already")));
  EXPECT_THAT(csv("file,kind\na.png,dark\n"),
              ThrowsMessage<ConfigError>(HasSubstr("has no exposure")));
}

TEST(CodeRange, IsTheLeastThatTheLargestCodeNeeds) {
  EXPECT_EQ(code_range(0xFF).bits, 8);
  EXPECT_EQ(code_range(0x3FF).bits, 10);
  EXPECT_EQ(code_range(0xFFF).bits, 12);
  EXPECT_EQ(code_range(0x1FFF).bits, 16);
  EXPECT_EQ(code_range(0xFFF0).bits, 12);  // twelve bits at the upper end
  EXPECT_EQ(code_range(0xFFF0).shift, 4);
  EXPECT_EQ(code_range(0xFFC0).bits, 10);
  EXPECT_EQ(code_range(0xFFFF).shift, 0);
  EXPECT_EQ(code_range(0).bits, 8);
}

// What the user says goes for place and size together: a gain of shifted codes beside the full
// scale of others would be off by the shift.
TEST(CodeRange, FollowsWhatIsSaidInShiftAndSize) {
  const auto expect_range = [](const CodeRange& range, int bits, int shift) {
    EXPECT_EQ(range.bits, bits);
    EXPECT_EQ(range.shift, shift);
  };
  expect_range(told_range(12, 0xFFF0), 12, 4);
  expect_range(told_range(16, 0xFFF0), 16, 0);
  expect_range(told_range(12, 0xFFC0), 12, 4);  // the guess would be 10 bits, shifted by 6
  expect_range(told_range(16, 0xFFFF), 16, 0);
  expect_range(told_range(12, 0x0FFF), 12, 0);
  expect_range(told_range(12, 0x00FF), 12, 0);
  expect_range(told_range(8, 0xFF00), 8, 8);
  const auto told = [](int bits, unsigned all) { return [=] { told_range(bits, all); }; };
  const auto refused =
      ThrowsMessage<ConfigError>(HasSubstr("the pictures hold larger codes, up to 12"));
  EXPECT_THAT(told(10, 0xFFF0), refused);
  EXPECT_THAT(told(8, 0xFFF), refused);
}

}  // namespace
}  // namespace glint
