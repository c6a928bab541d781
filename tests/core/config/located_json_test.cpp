// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/located_json.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

std::string json_error(const std::string& text) {
  try {
    parse_located_json(text, "j");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(LocatedJson, RefusesWhatIsNoJson) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "j:1:1: "},
      {"[1,]", "j:1:4: "},
      {"[1 2]", "j:1:4: "},
      {"[01]", "j:1:2: "},
      {"[1.]", "j:1:2: "},
      {"[.5]", "j:1:2: "},
      {"[NaN]", "j:1:2: "},
      {"[null]", "j:1:2: "},
      {"[1]\n x", "j:2:2: "},
      {R"({"a":1,"a":2})", "j:1:8: a: appears twice"},
      {R"(["\q"])", "j:1:4: "},
      {"[\"ab", "j:1:5: "},
      {"{a:1}", "j:1:2: "},
      {"[+1]", "j:1:2: "},
      {"[1e]", "j:1:2: "},
      {"[1e999]", "j:1:2: "},
      {"[1e-999]", "j:1:2: "},
      {"[1,\n2x]", "j:2:1: "},
      {"[\n 1\n", "j:3:1: "},
      {"[\"\xFF\"]", "j:1:3: "},
      {std::string("[1]\0", 4), "j:1:4: "},
      {std::string(100000, '['), "j:1:"}};
  for (const auto& [text, start] : wrong) {
    EXPECT_THAT(json_error(text), ::testing::StartsWith(start)) << text.substr(0, 20);
  }
}

TEST(LocatedJson, ReadsEveryKindOfValue) {
  const ConfigNode root = parse_located_json(
      "\xEF\xBB\xBF{\"a\": [1, -2.5e-3, true, false, {}], \"\\u00e9\\n\": \"\\\"\"}", "j");
  ASSERT_NE(root.at_path("a.1"), nullptr);
  EXPECT_EQ(root.at_path("a.1")->number, -0.0025);
  EXPECT_TRUE(root.at_path("a.2")->boolean);
  EXPECT_TRUE(root.at_path("a.4")->is_table());
  ASSERT_NE(root.find("\xC3\xA9\n"), nullptr);
  EXPECT_EQ(root.find("\xC3\xA9\n")->text, "\"");
}

// Line 2: a blank, "b" in columns 2 to 4, a colon, the array in column 6; line 3 begins with -0.
TEST(LocatedJson, EveryValueKnowsItsPlace) {
  const ConfigNode root = parse_located_json("{\"a\" : [1,{}],\n \"b\":[[],\n-0,\"\\\"\"] }", "j");
  const std::vector<std::pair<std::string, std::string>> places = {{"a", "j:1:8: "},
                                                                   {"a.0", "j:1:9: "},
                                                                   {"a.1", "j:1:11: "},
                                                                   {"b", "j:2:6: "},
                                                                   {"b.0", "j:2:7: "},
                                                                   {"b.1", "j:3:1: "},
                                                                   {"b.2", "j:3:4: "}};
  EXPECT_EQ(root.place.prefix(), "j:1:1: ");
  for (const auto& [path, place] : places) {
    ASSERT_NE(root.at_path(path), nullptr) << path;
    EXPECT_EQ(root.at_path(path)->place.prefix(), place) << path;
  }
  EXPECT_TRUE(std::signbit(root.at_path("b.1")->number));
}

}  // namespace
}  // namespace glint
