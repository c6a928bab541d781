// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first job of one's own: `glint new`, prototypes without a search, comparisons of runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> codes_in(const Json& result) {
  std::vector<std::string> codes;
  for (const Json& finding : result["verdict"]["findings"]) {
    codes.push_back(finding["code"].get<std::string>());
  }
  return codes;
}

/// mixed_study() as engineers compare prototypes: an objective, three designs, nothing to search.
std::string prototype_study() {
  const std::string text = edited(
      mixed_study(),
      {{"homogeneity.h_rms\"", "defects.min_dprime\""},
       {"\"homogeneity.clipped_share\" = { max = 0.9 }", "\"homogeneity.h_rms\" = { min = 0.2 }"}});
  const auto from = text.find("[variables]");
  const auto to = text.find("[objective]");
  const auto search = text.find("[search]");
  return text.substr(0, from) + text.substr(to, search - to);
}

TEST(NewStudy, StartsWithADentThatShowsAndEndsWithOneThatShowsBetter) {
  const TemporaryFolder folder;
  write_file(folder / "plate.stl", rectangle_stl(60, 20));
  const Json written =
      json_of(folder, {"new", "plate.stl", "--working_distance_mm", "300", "--out", "plate.toml"});
  EXPECT_EQ(written["is_dent_visible"], true);
  const Json result = json_of(
      folder, {"run", "plate.toml", "--out", "run", "--set", "budget.evaluations=12", "--quiet"});
  EXPECT_EQ(result["objective"], "defects.min_cnr");
  const double before = result["baseline"]["scores"]["defects.min_cnr"];
  EXPECT_NEAR(before, written["start_score"].get<double>(), 1e-6 * before);
  EXPECT_GE(before, 3.0);
  EXPECT_GE(result["best"]["scores"]["defects.min_cnr"].get<double>(), before);
  EXPECT_THAT(codes_in(result), Not(::testing::Contains("defects_fainter")));
}

// What is said of a study's keys is said of this verb's options and files.
TEST(NewStudy, NamesItsOwnOptionsInErrors) {
  const TemporaryFolder folder;
  write_file(folder / "tiny.stl", rectangle_stl(0.2, 0.04));
  const auto refused = [&](const Arguments& arguments, int code, const std::string& message) {
    const ProgramResult result = glint_in(folder, arguments);
    EXPECT_EQ(result.code, code);
    EXPECT_THAT(result.err, ::testing::MatchesRegex(message + "\n"));
  };
  refused({"new", "gone.stl"}, 3, "gone\\.stl: cannot be read: No such file or directory");
  refused({"new", "tiny.stl"}, 2, R"(--unit: tiny\.stl is 0\.2 mm large: is the file in m\?.*)");
  refused({"new", "tiny.stl", "--unit", "furlong"}, 2, "--unit: is \"furlong\", must be one of.*");
}

// A line break in a name ends no comment of the study.
TEST(NewStudy, TakesAnyNameForAPart) {
  const TemporaryFolder folder;
  const std::string name = "a\"b\\c\n[part] #.stl";
  write_file(folder / name, rectangle_stl(60, 20));
  json_of(folder, {"new", name, "--working_distance_mm", "300", "--out", "plate.toml"});
  const std::string text = read_file(folder / "plate.toml");
  EXPECT_THAT(text, HasSubstr("# A lighting study for a\"b\\c?[part] #.stl, written by"));
  EXPECT_THAT(text, HasSubstr("file = \"a\\\"b\\\\c\\n[part] #.stl\""));
}

TEST(NewStudy, AsJsonOnStdoutIsOneObject) {
  const TemporaryFolder folder;
  write_file(folder / "plate.stl", rectangle_stl(60, 20));
  const Json printed = json_of(folder, {"new", "plate.stl", "--working_distance_mm", "300"});
  EXPECT_THAT(printed["text"].get<std::string>(),
              AllOf(HasSubstr("maximise = \"defects.min_cnr\""), HasSubstr("[lighting.tunnel]")));
  EXPECT_EQ(folder.count(), 1) << "nothing is written";
  EXPECT_EQ(printed["is_dent_visible"], true);
  EXPECT_GT(printed["start_score"].get<double>(), 0.0);
}

/// A quarter of what `glint new` writes.
constexpr const char* kFewSamples = "render.paths.samples=8";

/// `glint new` for a small picture of a plate, into a file called like the light.
void write_new_study(const TemporaryFolder& folder, const std::string& light) {
  write_file(folder / "plate.stl", rectangle_stl(60, 20));
  json_of(folder,
          {"new",
           "plate.stl",
           "--working_distance_mm",
           "200",
           "--camera",
           "width_px=176,height_px=64,object_pixel_mm=0.4",
           "--light",
           light,
           "--out",
           light + ".toml"});
}

TEST(NewStudy, OfEachKindOfLightChecks) {
  const TemporaryFolder folder;
  for (const std::string light : {"ring", "dome", "bar"}) {
    SCOPED_TRACE(light);
    write_new_study(folder, light);
    const std::string text = read_file(folder / (light + ".toml"));
    EXPECT_THAT(text, HasSubstr("[lighting." + light + "]"));
    EXPECT_THAT(text, HasSubstr("maximise = \"defects.min_dprime\""));
    const Json checked = json_of(folder, {"check", light + ".toml", "--set", kFewSamples});
    EXPECT_TRUE(checked["insensitive_variables"].empty()) << checked["insensitive_variables"];
    const double mean = checked["baseline"]["scores"]["homogeneity.mean"];
    EXPECT_GT(mean, 0.15);
    EXPECT_LT(mean, 0.75);
  }
}

TEST(NewStudy, OfAllLightsRanksThem) {
  const TemporaryFolder folder;
  write_new_study(folder, "all");
  const Json result =
      json_of(folder, {"run", "all.toml", "--out", "all", "--quiet", "--set", kFewSamples});
  ASSERT_EQ(result["ranking"].size(), 4U);
  double sum = 0.0;
  for (const Json& row : result["ranking"]) {
    EXPECT_LE(row["low"].get<double>(), row["value"].get<double>());
    sum += row["probability_best"].get<double>();
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(Prototypes, WithoutVariablesAreRankedByTheObjective) {
  const TemporaryFolder folder;
  write_file(folder / "two.toml", prototype_study());
  const Json result = json_of(folder, {"run", "two.toml", "--out", "two", "--quiet"});
  ASSERT_EQ(result["ranking"].size(), 3U);
  EXPECT_GE(result["ranking"][0]["value"].get<double>(),
            result["ranking"][1]["value"].get<double>());
  EXPECT_THAT(codes_in(result), ::testing::Contains("ranked"));
  EXPECT_THAT(read_file(folder / "two/report.html"), Not(HasSubstr("no objective is set")));
  const ProgramResult printed = glint_in(folder, {"run", "two.toml", "--out", "two"});
  EXPECT_THAT(printed.out, ::testing::StartsWith("done: 3 designs, no search\n"));
  EXPECT_THAT(printed.out, HasSubstr("Of 3 designs, "));
  EXPECT_GT(json_of(folder, {"check", "two.toml"})["predicted_s"].get<double>(), 0.0);
}

TEST(Prototypes, ThatMissALimitAreSaidToMissIt) {
  const TemporaryFolder folder;
  write_file(folder / "two.toml",
             edited(prototype_study(), {{"{ min = 0.2 }", "{ min = 0.9999 }"}}));
  const ProgramResult printed = glint_in(folder, {"run", "two.toml", "--out", "two"});
  EXPECT_THAT(printed.out, HasSubstr("It misses a limit: h (rms) is "));
  EXPECT_THAT(printed.out, HasSubstr("must be at least 99.99 %"));
}

TEST(InfeasibleRun, SaysWhichLimitFailedAndCallsNoDesignAWinner) {
  const TemporaryFolder folder;
  write_file(
      folder / "study.toml",
      edited(small_study(),
             {{"\"defects.min_cnr\" = { min = 0.1 }", "\"defects.min_cnr\" = { min = 1e6 }"}}));
  const ProgramResult printed = glint_in(folder, {"run", "study.toml", "--out", "out"});
  EXPECT_EQ(printed.code, 1);
  EXPECT_THAT(printed.out,
              ::testing::StartsWith("no feasible design: 12 evaluations, 0 failed; ended by"));
  EXPECT_THAT(printed.out, HasSubstr("closest (trial "));
  EXPECT_THAT(printed.out, HasSubstr("must be at least 1.000\u00a0\u00d7\u00a010\u2076"));
  EXPECT_THAT(printed.out, Not(HasSubstr("winner")));
  // The best of designs that are not feasible is no best.
  EXPECT_THAT(printed.err, HasSubstr("none feasible yet"));
  EXPECT_THAT(printed.err, Not(HasSubstr("best 0.")));
}

TEST(ComparisonOfRuns, NamesDesignsByTheirRunAndRanksWhatBelongsTogether) {
  const TemporaryFolder folder;
  write_file(folder / "a.toml", small_study());
  write_file(folder / "b.toml", edited(small_study(), {{"radius_mm = 80", "radius_mm = 90"}}));
  write_file(folder / "c.toml", edited(small_study(), {{"length_mm = 40", "length_mm = 36"}}));
  for (const auto& [name, title] :
       {std::pair("a", "First"), std::pair("b", "Second"), std::pair("c", "Third")}) {
    json_of(folder,
            {"run",
             std::string(name) + ".toml",
             "--out",
             name,
             "--quiet",
             "--set",
             std::string("title=") + title});
  }
  json_of(folder, {"report", "a", "b", "--out", "same.html"});
  const std::string same = read_file(folder / "same.html");
  EXPECT_THAT(same, HasSubstr("Of 2 runs, "));
  EXPECT_THAT(same, HasSubstr("Winner of the search, First"));
  EXPECT_THAT(same, HasSubstr("Baseline, Second"));
  json_of(folder, {"report", "a", "c", "--out", "other.html"});
  const std::string other = read_file(folder / "other.html");
  EXPECT_THAT(other, HasSubstr("These 2 runs are not ranked together"));
  EXPECT_THAT(other, HasSubstr("Third differs from First in part (length_mm)"));
}

}  // namespace
}  // namespace glint::test
