// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wrong command lines: exit 2, one line, nothing written.
#include <algorithm>

#include "tests/cli/program.h"

namespace glint::test {
namespace {

/// Runs in a folder that holds study.toml.
void expect_usage_error(const Arguments& arguments, const std::string& message) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  const ProgramResult result = glint_in(folder, arguments);
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, ::testing::MatchesRegex(message + "\n"));
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(folder.count(), 1) << "something is left behind";
}

TEST(UsageError, UnknownVerbNamesTheNearest) {
  expect_usage_error({"rum", "study.toml"}, "glint rum: no such verb, the nearest is run");
}

TEST(UsageError, NoVerb) {
  expect_usage_error({}, "glint: a verb is needed: run, check, render, .*");
}

TEST(UsageError, UnknownOptionNamesTheNearest) {
  expect_usage_error({"run", "study.toml", "--job", "3"},
                     "glint run: --job: no such option, the nearest is --jobs");
}

TEST(UsageError, MissingArgument) {
  expect_usage_error({"run"}, "glint run: STUDY\\.toml is required");
  expect_usage_error({"report"}, "glint report: DIR is required");
}

TEST(UsageError, JournalAndPageAtOnce) {
  expect_usage_error({"report", "run", "--optuna", "a.log", "--out", "a.html"}, ".*--out.*");
}

// --out "$folder" of a variable that is not set.
TEST(UsageError, EmptyNames) {
  expect_usage_error({"run", "study.toml", "--out", ""},
                     "glint run: --out: is empty, must be a name");
  expect_usage_error({"report", "study.toml", "--optuna", ""},
                     "glint report: --optuna: is empty, must be a name");
  expect_usage_error({"report", "study.toml", "--out", ""},
                     "glint report: --out: is empty, must be a name");
  expect_usage_error({"run", "study.toml", "--log", ""},
                     "glint run: --log: is empty, must be a name");
}

TEST(UsageError, WrongNumbers) {
  expect_usage_error({"run", "study.toml", "--threads", "0"},
                     "glint run: --threads: Value 0 not in range 1 to 1024");
  expect_usage_error({"run", "study.toml", "--seed", "-1"},
                     "glint run: --seed: Value -1 not in range 0 to 2147483647");
  for (const std::string distance : {"0", "-5", "nan", "inf", "1e300", "far"}) {
    expect_usage_error(
        {"new", "plate.stl", "--working_distance_mm", distance},
        "glint new: --working_distance_mm: is " + distance + ", must be a number from 1 to 100000");
  }
  expect_usage_error({"part", "plate.stl", "--slope_mrad", "nan"},
                     "glint part: --slope_mrad: is nan, must be a number > 0");
  expect_usage_error({"part", "plate.stl", "--crease_deg", "nan"},
                     "glint part: --crease_deg: is nan, must be a number from 0 to 180");
}

// JSON and TOML cannot hold them: refused before anything is computed.
TEST(UsageError, NamesThatAreNoUtf8) {
  expect_usage_error({"run", "study.toml", "--out", "out\xff"},
                     "glint: out\xff: is no UTF-8 text, as all names must be");
  expect_usage_error({"check", "s\xc3.toml"}, "glint: s\xc3\\.toml: is no UTF-8 text, .*");
}

TEST(UsageError, WrongBudget) {
  for (const std::string budget : {"3x", "0", "-5s", "8 h"}) {
    expect_usage_error({"run", "study.toml", "--budget=" + budget},
                       "--budget " + budget + ": must be a duration like 40s, 30m or 8h");
  }
}

TEST(UsageError, SetWithoutEquals) {
  expect_usage_error({"run", "study.toml", "--set", "scan.positions"},
                     "--set scan\\.positions: must be key=value");
}

TEST(UsageError, SetOfAnUnknownKeyNamesTheNearest) {
  expect_usage_error({"run", "study.toml", "--set", "lighting.tunnel.raduis_mm=90"},
                     "--set: lighting\\.tunnel\\.raduis_mm: unknown key, the nearest known one is "
                     "\"radius_mm\"");
  expect_usage_error({"run", "study.toml", "--set", "scn.positions=9"},
                     "--set: scn: unknown table, the nearest known one is \"scan\"");
}

TEST(UsageError, SetWithoutAPlace) {
  expect_usage_error({"run", "study.toml", "--set", "part.length_mm.x=3"},
                     R"(--set: part\.length_mm\.x: "length_mm" is a plain value and has no keys)");
  expect_usage_error({"run", "study.toml", "--set", "variables.\"a.b=3"},
                     R"(--set: variables\."a\.b is no key path)");
}

TEST(UsageError, ReportOfNoRunDirectory) {
  const TemporaryFolder folder;
  const ProgramResult result = glint_in(folder, {"report", "."});
  EXPECT_EQ(result.code, 3);
  EXPECT_EQ(result.err, ".: is no run directory: study.resolved.toml is missing\n");
  EXPECT_EQ(folder.count(), 0);
}

TEST(UsageError, ExplainOfAnUnknownKeyNamesTheNearest) {
  expect_usage_error({"explain", "lighting.tunnel.raduis_mm"},
                     "lighting\\.tunnel\\.raduis_mm: no such key or score, the nearest is "
                     "lighting\\.tunnel\\.radius_mm");
  expect_usage_error({"explain", "homogenity"},
                     "homogenity: no such key or score, the nearest is [a-z._0-9]+");
}

// The path of a variable has dots of its own; quotes keep it together.
TEST(SetOption, ReachesAVariableThroughQuotes) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", small_study());
  const ProgramResult result = glint_in(
      folder, {"check", "study.toml", "--set", "variables.\"lighting.tunnel.radius_mm\".min=200"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err,
              ::testing::HasSubstr("lighting.tunnel.radius_mm: min 200 is above max 120"));
}

}  // namespace
}  // namespace glint::test
