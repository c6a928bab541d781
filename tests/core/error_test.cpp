// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/error.h"

#include <cerrno>

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(Place, PrefixIsShortenedByWhatIsUnknown) {
  EXPECT_EQ((Place{.file = "a.toml", .line = 3, .column = 7}).prefix(), "a.toml:3:7: ");
  EXPECT_EQ((Place{.file = "a.toml", .line = 3, .column = 0}).prefix(), "a.toml:3: ");
  EXPECT_EQ((Place{.file = "a.toml", .line = 0, .column = 7}).prefix(), "a.toml: ");
  EXPECT_EQ((Place{.file = "", .line = 3, .column = 7}).prefix(), "");
}

TEST(Error, KindsAreToldApartButShareABase) {
  EXPECT_THROW(throw ConfigError("x"), Error);
  EXPECT_THROW(throw IoError("x"), Error);
  const auto throw_io = [] { throw IoError("x"); };
  bool is_config = false;
  try {
    throw_io();
  } catch (const ConfigError&) {
    is_config = true;
  } catch (const Error&) {
    is_config = false;
  }
  EXPECT_FALSE(is_config);
}

TEST(Problem, MessageLeavesOutWhatIsUnknown) {
  Problem problem = {.text = "is 3"};
  EXPECT_EQ(problem.message(), "is 3");
  problem.key = "camera.x";
  EXPECT_EQ(problem.message(), "camera.x: is 3");
  problem.place = {.file = "a.toml", .line = 3, .column = 7};
  problem.context = "prototypes.flat";
  EXPECT_EQ(problem.message(), "a.toml:3:7: prototypes.flat: camera.x: is 3");
}

TEST(ConfigError, HoldsItsProblemsAndTellsEachOnALine) {
  const ConfigError error(std::vector<Problem>{{.key = "a", .text = "is 3"}, {.text = "is bad"}});
  EXPECT_STREQ(error.what(), "a: is 3\nis bad");
  ASSERT_EQ(error.problems().size(), 2U);
  EXPECT_EQ(error.problems()[0].key, "a");
  EXPECT_EQ(ConfigError("part.unit", "is 3").problems()[0].key, "part.unit");
  EXPECT_EQ(ConfigError("part.unit: is 3").problems()[0].key, "");
}

TEST(LastSystemError, IsTheSystemsSentence) {
  errno = ENOENT;
  EXPECT_EQ(last_system_error(), "No such file or directory");
}

TEST(GlintCheckDeathTest, AbortsNamingConditionAndText) {
  EXPECT_DEATH(GLINT_CHECK(1 > 2, "one is more than two"),
               "error_test.cpp:[0-9]+: check failed: one is more than two \\(1 > 2\\)");
  GLINT_CHECK(2 > 1, "never said");
}

}  // namespace
}  // namespace glint
