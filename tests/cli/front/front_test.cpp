// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint run` and `glint report` with several objectives: results, resuming, the page, and what is
// refused, each in one line with its place.
#include <algorithm>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/support/page_data.h"

namespace glint::test {
namespace {

using Json = nlohmann::json;

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

/// Evenness against the width of the tunnel.
std::string trade_off_study() {
  return edited(small_study(),
                {{"[objective]\nmaximise = \"homogeneity.h_rms\"\n",
                  "[[objective]]\nmaximise = \"homogeneity.h_rms\"\n"
                  "[[objective]]\nminimise = \"lighting.width_mm\"\n"}});
}

class FrontOfProgram : public ::testing::Test {
 protected:
  void write(const std::string& study) { write_file(folder_ / "study.toml", study); }

  Json run(const std::string& out, const Arguments& more = {}) {
    Arguments arguments = {"run", "study.toml", "--quiet", "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json_of(folder_, arguments);
  }

  void expect_refused(const std::string& study, const std::string& message) {
    write(study);
    const ProgramResult result = glint_in(folder_, {"run", "study.toml", "--out", "out"});
    EXPECT_EQ(result.code, 2);
    EXPECT_THAT(result.err, MatchesRegex(message + "\n"));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }

  TemporaryFolder folder_;
};

TEST_F(FrontOfProgram, JsonHoldsFrontHypervolumeReferenceAndChosen) {
  write(trade_off_study());
  const Json result = run("out");
  ASSERT_GE(result.at("front").size(), 2U);
  std::vector<std::pair<double, double>> designs;
  for (const Json& design : result["front"]) {
    const Json& scores = design.at("scores");
    designs.emplace_back(scores.at("lighting.width_mm"), scores.at("homogeneity.h_rms"));
    // A semicylinder is twice its radius wide.
    EXPECT_NEAR(scores["lighting.width_mm"].get<double>(),
                2.0 * design.at("variables").at("lighting.tunnel.radius_mm").get<double>(),
                1e-9);
    EXPECT_TRUE(design.at("trial").is_number_integer());
    EXPECT_TRUE(design.at("errors").is_object());
  }
  std::ranges::sort(designs);
  for (std::size_t i = 1; i < designs.size(); ++i) {
    EXPECT_LT(designs[i - 1].second, designs[i].second) << "a wider tunnel must be more even";
  }
  EXPECT_GT(result.at("hypervolume").get<double>(), 0.0);
  EXPECT_EQ(result.at("reference").size(), 2U);
  const Json& chosen = result.at("chosen");
  EXPECT_EQ(chosen.at("by"), "knee");
  EXPECT_FALSE(chosen.at("reason").get<std::string>().empty());
  EXPECT_EQ(chosen.at("trial"), result.at("best").at("trial"));
  EXPECT_EQ(Json::parse(read_file(folder_ / "out/result.json")).at("front"), result["front"]);
}

TEST_F(FrontOfProgram, ARunThatGoesOnEndsWithTheSameBytes) {
  write(trade_off_study());
  run("whole");
  run("parts", {"--set", "budget.evaluations=7"});
  run("parts");
  expect_same_files(folder_ / "parts", folder_ / "whole");
}

TEST_F(FrontOfProgram, TheReportShowsIt) {
  write(trade_off_study());
  const Json result = run("out");
  const ProgramResult report = glint_in(folder_, {"report", "out", "--out", "page.html"});
  EXPECT_EQ(report.code, 0) << report.err;
  const Json page = page_data(read_file(folder_ / "page.html"));
  const Json& designs = page.at("front").at("designs");
  ASSERT_EQ(designs.size(), result.at("front").size());
  for (std::size_t i = 0; i < designs.size(); ++i) {
    for (const char* name : {"trial", "variables", "scores"}) {
      EXPECT_EQ(designs[i].at(name), result["front"][i].at(name)) << name;
    }
  }
  EXPECT_EQ(page["front"].at("objectives")[1].at("score"), "lighting.width_mm");
  EXPECT_EQ(page["front"]["objectives"][1].at("direction"), "minimise");
}

// A reference that most of the front does not reach leaves those designs out, which is said once.
TEST_F(FrontOfProgram, AReferenceInsideTheFrontIsToldInOneLine) {
  write(edited(trade_off_study(),
               {{"minimise = \"lighting.width_mm\"\n",
                 "minimise = \"lighting.width_mm\"\nreference = 125\n"}}));
  const Json result = run("out");
  int told = 0;
  for (const Json& finding : result.at("verdict").at("findings")) {
    told += finding.at("code") == "reference_inside" ? 1 : 0;
  }
  EXPECT_EQ(told, 1);
  const Json warnings = Json::parse(read_file(folder_ / "out/run.json")).at("warnings");
  EXPECT_THAT(warnings.dump(), HasSubstr("reference"));
}

TEST_F(FrontOfProgram, AnObjectiveTwiceIsRefused) {
  const std::string study =
      edited(trade_off_study(),
             {{"minimise = \"lighting.width_mm\"", "minimise = \"homogeneity.h_rms\""}});
  expect_refused(study,
                 "study\\.toml:[0-9]+:1: objective\\.1: \"homogeneity\\.h_rms\" is an objective "
                 "twice; allowed: each score once");
}

TEST_F(FrontOfProgram, UnknownAndUnknowableScoresAreRefused) {
  const std::string misspelt =
      edited(trade_off_study(), {{"lighting.width_mm", "lighting.widht_mm"}});
  expect_refused(misspelt,
                 place_of(misspelt, "minimise =") +
                     "objective\\.1\\.minimise: \"lighting\\.widht_mm\" is no score, did you mean "
                     "\"lighting\\.width_mm\"\\?");
  const std::string unpriced = edited(trade_off_study(), {{"lighting.width_mm", "cost.total"}});
  expect_refused(unpriced,
                 place_of(unpriced, "minimise =") +
                     "objective\\.1\\.minimise: \"cost\\.total\" needs a price: cost\\.per_mm2, "
                     "cost\\.per_led or cost\\.per_frame");
}

TEST_F(FrontOfProgram, ContradictoryLimitsAreRefused) {
  const std::string study = edited(trade_off_study(), {{"{ min = 0.1 }", "{ min = 3, max = 1 }"}});
  expect_refused(study,
                 place_of(study, "\"defects.min_cnr\"") +
                     "constraints: defects\\.min_cnr: min 3 is above max 1, which no design can "
                     "keep");
}

TEST_F(FrontOfProgram, TargetAndMethodsOfOneObjectiveAreRefused) {
  const std::string target =
      edited(trade_off_study(), {{"evaluations = 12", "evaluations = 12\ntarget = 0.9"}});
  expect_refused(target,
                 place_of(target, "target") +
                     "budget\\.target: works with a single objective only, this study has several; "
                     "allowed: budget\\.stall, evaluations without a gain of hypervolume");
  for (const std::string method : {"bobyqa", "cobyla", "sbplx", "direct_l", "slsqp"}) {
    const std::string study =
        edited(trade_off_study(), {{"batch = 2", "batch = 2\nalgorithm = \"" + method + "\""}});
    expect_refused(
        study,
        place_of(study, "algorithm") + "search\\.algorithm: \"" + method +
            "\" works with a single objective only, this study has 2; allowed: \"auto\", "
            "\"gp\", .*\"sobol\", \"random\"");
  }
}

TEST_F(FrontOfProgram, AConditionOnAnUnknownVariableIsRefused) {
  const std::string study = edited(
      trade_off_study(),
      {{"\"lighting.tunnel.base_mm\" = { min = -10, max = 10 }",
        R"("lighting.tunnel.base_mm" = { min = -10, max = 10, when = "lighting_use == ring" })"}});
  expect_refused(study,
                 place_of(study, "when =") +
                     "variables: lighting\\.tunnel\\.base_mm: when names the unknown variable "
                     "\"lighting_use\".*");
}

TEST_F(FrontOfProgram, AChoiceOfOneIsRefused) {
  const std::string one_value =
      edited(trade_off_study(),
             {{"[variables]\n",
               "[variables]\n\"lighting.tunnel.shape\" = { choices = [\"ellipse\"] }\n"}});
  expect_refused(one_value,
                 place_of(one_value, "choices =") +
                     "variables: lighting\\.tunnel\\.shape: has a single choice; give two or more, "
                     "or set the key itself");
  const std::string one_objective = small_study() + "[choice]\nby = \"knee\"\n";
  expect_refused(one_objective,
                 "study\\.toml:[0-9]+:2: choice: chooses between several objectives; allowed only "
                 "with two or more \\[\\[objective\\]\\] tables");
  const std::string list_of_one = edited(small_study(), {{"[objective]", "[[objective]]"}});
  expect_refused(list_of_one,
                 "study\\.toml:[0-9]+:[0-9]+: objective: \\[\\[objective\\]\\] is for several, "
                 "there is one; allowed: two or more, or \\[objective\\]");
}

}  // namespace
}  // namespace glint::test
