// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/renamed_key.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Retakes {
  int max = 2;
};

void visit_keys(KeyVisitor& keys, Retakes& retakes) {
  keys.integer(name_in_table(keys, "max_retakes", "most_retakes"),
               retakes.max,
               Range::between(0, 20),
               "of one picture");
}

struct ReadRetakes {
  int max = 0;
  std::string log;
  std::vector<Problem> problems;
};

ReadRetakes read_retakes(const std::string& text) {
  const ConfigNode root = parse_toml(text, "cell.toml");
  ReadRetakes read;
  Retakes retakes;
  KeyReader reader(&root, "acquisition", read.problems);
  testing::internal::CaptureStderr();
  visit_keys(reader, retakes);
  read.log = testing::internal::GetCapturedStderr();
  reader.report_unknown();
  read.max = retakes.max;
  return read;
}

TEST(RenamedKey, IsReadUnderBothNames) {
  const ReadRetakes now = read_retakes("max_retakes = 5\n");
  EXPECT_EQ(now.max, 5);
  EXPECT_EQ(now.log, "");
  EXPECT_THAT(now.problems, IsEmpty());
  const ReadRetakes before = read_retakes("most_retakes = 7\n");
  EXPECT_EQ(before.max, 7);
  EXPECT_THAT(before.log, HasSubstr("most_retakes is called max_retakes now"));
  EXPECT_THAT(before.problems, IsEmpty());
  EXPECT_EQ(read_retakes("").max, 2);
}

TEST(RenamedKey, HasTheRangeUnderItsFormerNameAndNotBothNames) {
  const ReadRetakes wrong = read_retakes("most_retakes = 50\n");
  ASSERT_EQ(wrong.problems.size(), 1U);
  EXPECT_EQ(wrong.problems[0].key, "acquisition.most_retakes");
  const ReadRetakes both = read_retakes("max_retakes = 5\nmost_retakes = 7\n");
  ASSERT_EQ(both.problems.size(), 1U);
  EXPECT_EQ(both.problems[0].kind, Problem::Kind::kUnknownKey);
  EXPECT_EQ(both.problems[0].key, "acquisition.most_retakes");
}

}  // namespace
}  // namespace glint
