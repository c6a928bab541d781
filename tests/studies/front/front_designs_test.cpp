// SPDX-License-Identifier: GPL-3.0-or-later
//
// Designs of a front after the search: which are shown, and what fresh scores leave of them.
#include "studies/front/front_designs.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "studies/front/front_page.h"
#include "studies/front/front_run.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// Much of "even", little of "width"; "cnr" limited.
Goal goal_of_two() {
  return {.objective = {.name = "even"},
          .constraints = {{.name = "cnr", .min = 3.0, .max = std::nullopt}},
          .more_objectives = {{.name = "width", .is_maximised = false}}};
}

Json design(int trial, double even, double width) {
  return {{"trial", trial},
          {"variables", Json::object()},
          {"scores", {{"even", even}, {"width", width}, {"cnr", 4.0}}},
          {"errors", Json::object()}};
}

Json front_of_three() {
  return {{"designs", {design(3, 1, 1), design(5, 2, 2), design(8, 4, 4)}},
          {"reference", {{"even", 0.0}, {"width", 5.0}}},
          {"chosen", {{"trial", 8}}}};
}

Json written(double even, double width, double cnr, double error) {
  return {{"rescored",
           {{"even", even},
            {"even.error", error},
            {"width", width},
            {"width.error", error},
            {"cnr", cnr}}}};
}

TEST(PlanFront, CountsWhatIsLostWithoutADesign) {
  Json front = front_of_three();
  plan_front(goal_of_two(), front);
  // Corners (even, 5 - width): (1, 4), (2, 3), (4, 1). Without the first, the strip of even below 1
  // and between 3 and 4: 1 x 1; without the second, from 1 to 2 and 1 to 3: 1 x 2; without the
  // third, from 2 to 4 and below 1: 2 x 1.
  EXPECT_DOUBLE_EQ(front["designs"][0]["contribution"].get<double>(), 1.0);
  EXPECT_DOUBLE_EQ(front["designs"][1]["contribution"].get<double>(), 2.0);
  EXPECT_DOUBLE_EQ(front["designs"][2]["contribution"].get<double>(), 2.0);
  EXPECT_EQ(front["designs"][0]["folder"], "front/trial_003");
  EXPECT_EQ(front["designs"][2]["folder"], "winner");
}

TEST(PlanFront, ShowsTheLargestContributionsInFullAndTheChosenOneAlways) {
  Json front = {{"designs", Json::array()},
                {"reference", {{"even", 0.0}, {"width", 1000.0}}},
                {"chosen", {{"trial", 1}}}};
  // Steps that grow: later designs contribute more, the first one least.
  for (int k = 0; k < 300; ++k) {
    front["designs"].push_back(design(k + 1, 1.0 + k * k, 10.0 + k));
  }
  plan_front(goal_of_two(), front);
  const auto shown = [&](int trial) {
    return front["designs"][static_cast<std::size_t>(trial - 1)]["shown"];
  };
  EXPECT_EQ(shown(1), "full");
  EXPECT_EQ(shown(300), "full");
  EXPECT_EQ(shown(2), "none");
  int full = 0;
  int small = 0;
  for (const Json& one : front["designs"]) {
    full += one["shown"] == "full" ? 1 : 0;
    small += one["shown"] == "thumbnail" ? 1 : 0;
    EXPECT_EQ(one.contains("folder"), one["shown"] != "none");
  }
  EXPECT_EQ(full, kFullDesigns);
  EXPECT_EQ(small, kThumbnailDesigns);
}

TEST(AddRescored, TakesTheScoresOwnErrorOrTheSpreadOfScans) {
  Json one = design(3, 1, 1);
  Json file = written(0.9, 1.1, 2.5, 0.2);
  file["rescored"].erase("width.error");
  file["repeated"] = {{"width", {1.0, 2.0, 3.0}}};
  add_rescored(goal_of_two(), file, one);
  EXPECT_EQ(one["rescored"], (Json{{"even", 0.9}, {"width", 1.1}, {"cnr", 2.5}}));
  // Deviations -1, 0, 1: their squares over 2 are 1.
  EXPECT_EQ(one["rescored_errors"], (Json{{"even", 0.2}, {"width", 1.0}}));
  EXPECT_EQ(one["keeps_limits"], false);
  // Student with 2 degrees of freedom: 4.3027 x 1 / sqrt(3).
  EXPECT_NEAR(one["told"]["width"]["value"].get<double>(), 2.0, 1e-12);
  EXPECT_NEAR(one["told"]["width"]["high"].get<double>(), 2.0 + 2.4841, 1e-3);
  EXPECT_FALSE(one["told"].contains("even")) << "not scanned";
  // The model's sd of 0 and the noise of one scan, 1, weigh as much as one scan: (3 x 2 + 6) / 4.
  Json modelled = design(4, 1, 1);
  modelled["expected"] = {{"width", {{"value", 6.0}, {"sd", 0.0}}}};
  add_rescored(goal_of_two(), file, modelled);
  EXPECT_NEAR(modelled["told"]["width"]["value"].get<double>(), 3.0, 1e-12);
  Json untouched = design(5, 2, 2);
  add_rescored(goal_of_two(), {{"rescored", nullptr}}, untouched);
  EXPECT_EQ(untouched, design(5, 2, 2));
}

TEST(JudgeFront, MarksWhatAnotherDesignBeatsWithFreshSeeds) {
  Json front = front_of_three();
  const Goal goal = goal_of_two();
  add_rescored(goal, written(1.0, 1.0, 4.0, 0.0), front["designs"][0]);
  add_rescored(goal, written(1.0, 2.0, 4.0, 0.0), front["designs"][1]);  // it had luck
  add_rescored(goal, written(3.5, 4.0, 4.0, 0.0), front["designs"][2]);
  const Json summary = judge_front(goal, front);
  EXPECT_FALSE(front["designs"][0].contains("dominated_by"));
  EXPECT_EQ(front["designs"][1]["dominated_by"], 3);
  EXPECT_EQ(front["designs"][1]["probability_on_front"], 0.0);
  EXPECT_EQ(front["designs"][0]["probability_on_front"], 1.0);
  EXPECT_EQ(summary["designs"], 3);
  EXPECT_EQ(summary["dominated"], 1);
  // The search's corners (1, 4), (2, 3), (4, 1): 4 + 3 + 2; fresh (1, 4), (1, 3), (3.5, 1): 4
  // + 2.5.
  EXPECT_DOUBLE_EQ(summary["searched"].get<double>(), 9.0);
  EXPECT_DOUBLE_EQ(summary["hypervolume"].get<double>(), 6.5);
}

TEST(JudgeFront, PropagatesTheErrorsToTheHypervolume) {
  Json front = front_of_three();
  const Goal goal = goal_of_two();
  add_rescored(goal, written(2.0, 2.0, 4.0, 0.1), front["designs"][1]);
  // One design: 2 x 3. With 1.8 even 1.8 x 3, with 2.2 wide 2 x 2.8: sqrt(0.6^2 + 0.4^2).
  EXPECT_NEAR(judge_front(goal, front)["noise"].get<double>(), std::sqrt(0.52), 1e-12);
  front["designs"][1]["rescored_errors"].erase("width");
  EXPECT_TRUE(judge_front(goal, front)["noise"].is_null());
}

TEST(JudgeFront, ADesignThatLostALimitBeatsNone) {
  Json front = front_of_three();
  const Goal goal = goal_of_two();
  add_rescored(goal, written(9.0, 0.5, 2.9, 0.0), front["designs"][0]);
  add_rescored(goal, written(2.0, 2.0, 4.0, 0.0), front["designs"][1]);
  EXPECT_EQ(judge_front(goal, front)["dominated"], 0);
  EXPECT_EQ(front["designs"][0]["keeps_limits"], false);
  EXPECT_FALSE(front["designs"][0].contains("probability_on_front"));
}

// Two designs that differ by their noise alone: the second is beaten where both differences have
// the wrong sign, one time of four.
TEST(JudgeFront, TellsHowSurelyADesignIsOnTheFront) {
  Json front = front_of_three();
  front["designs"].erase(2);
  const Goal goal = goal_of_two();
  add_rescored(goal, written(1.0, 1.0, 4.0, 0.3), front["designs"][0]);
  add_rescored(goal, written(1.0, 1.0, 4.0, 0.3), front["designs"][1]);
  judge_front(goal, front);
  for (const Json& one : front["designs"]) {
    // 4000 draws: three standard errors are 0.021.
    EXPECT_NEAR(one["probability_on_front"].get<double>(), 0.75, 0.021);
  }
}

TEST(JudgeFront, TellsNoProbabilityWithoutErrors) {
  Json front = front_of_three();
  const Goal goal = goal_of_two();
  add_rescored(
      goal, {{"rescored", {{"even", 1.0}, {"width", 1.0}, {"cnr", 4.0}}}}, front["designs"][0]);
  judge_front(goal, front);
  EXPECT_EQ(front["designs"][0]["keeps_limits"], true);
  EXPECT_FALSE(front["designs"][0].contains("probability_on_front"));
}

TEST(LimitSequences, KeepsWhatFitsAndSaysWhatIsLeftOut) {
  const std::string frame(1000, 'x');
  Json data = {{"designs",
                {{{"frames", Json(std::vector<std::string>(24, frame))}},
                 {{"frames", Json(std::vector<std::string>(1, frame))}}}},
               {"methods", Json::array()}};
  Json whole = data;
  limit_sequences(whole, 30'000);
  EXPECT_EQ(whole, data);
  limit_sequences(data, 8'000);
  EXPECT_EQ(data["designs"][0]["frames"].size(), 6U);
  EXPECT_EQ(data["designs"][1]["frames"].size(), 1U);
  EXPECT_NE(data["methods"][0].get<std::string>().find("every 4th image"), std::string::npos);
  EXPECT_LE(data.dump().size(), 8'000U);
}

TEST(LimitSequences, DropsTheSmallPicturesThatMatterLeastWhereFramesAreNotEnough) {
  Json data = {{"designs", Json::array()},
               {"methods", Json::array()},
               {"front", {{"designs", Json::array()}}}};
  for (int k = 0; k < 10; ++k) {
    data["front"]["designs"].push_back({{"trial", k},
                                        {"contribution", (7 * k) % 10},
                                        {"thumbnail", std::string(900, 'x')},
                                        {"drawing", "<svg>"}});
  }
  limit_sequences(data, 5'000);
  int kept = 0;
  for (const Json& one : data["front"]["designs"]) {
    const bool has_picture = one.contains("thumbnail");
    kept += has_picture ? 1 : 0;
    EXPECT_EQ(has_picture, one["contribution"].get<int>() >= 6) << one["trial"];
    EXPECT_EQ(one.contains("drawing"), has_picture);
  }
  EXPECT_EQ(kept, 4);
  EXPECT_NE(data["methods"].back().get<std::string>().find("pictures of 6 designs"),
            std::string::npos);
}

/// Of two designs that were seen on the front, models expect that the second misses a limit.
TEST(FrontPage, HasTheFrontOfARunWhoseModelsJudgedTheLimits) {
  const TemporaryFolder run;
  const auto made_front = [](const std::vector<int>& trials) {
    Json front = {{"objectives", Json::array()},
                  {"designs", Json::array()},
                  {"hypervolume", 1.0 * static_cast<double>(trials.size())},
                  {"reference", Json::object()},
                  {"chosen", {{"trial", trials.front()}}}};
    for (const char* name : kOfExpected) {
      front[name] = trials.size();
    }
    for (const int trial : trials) {
      front["designs"].push_back({{"trial", trial}});
    }
    return front;
  };
  Json of_run = made_front({1});
  of_run["is_likely"] = true;
  Json result = Json::object();
  add_front_to_result(of_run, result);
  EXPECT_FALSE(result.contains("front_expected"));
  Json front = made_front({1, 2});
  add_front_to_page(
      run.path(), result, [](const auto&, const ImageF&) { return Json::array(); }, front);
  EXPECT_EQ(front["designs"].size(), 1U);
  EXPECT_EQ(front["history"], 1);
  EXPECT_EQ(front["hypervolume"], 1.0);
  EXPECT_FALSE(front.contains("is_expected"));
  Json seen = Json::object();
  add_front_to_result(made_front({1}), seen);
  EXPECT_FALSE(seen.contains("front_likely"));
}

TEST(FrontPage, NamesScoresThatWereCutShort) {
  const TemporaryFolder run;
  std::filesystem::create_directories(run / "winner");
  write_file(run / "winner/cross_section.svg", "<svg/>");
  write_exr(run / "winner/aspect.exr", ImageF(8, 8, 0.5F));
  write_file(run / "winner/scores.json", R"({"notes": ["the wa)");
  Json front = {{"designs", Json::array({{{"trial", 8}, {"folder", "winner"}}})}};
  const auto closeups = [](const auto&, const ImageF&) { return Json::array(); };
  EXPECT_THAT(text_thrown_by<IoError>(
                  [&] { add_front_to_page(run.path(), Json::object(), closeups, front); }),
              ::testing::HasSubstr("winner/scores.json: is damaged"));
}

}  // namespace
}  // namespace glint
