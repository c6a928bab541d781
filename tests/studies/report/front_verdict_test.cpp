// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the verdict says of a front, and that it goes with its cause.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

constexpr const char* kEven = "homogeneity.h_rms";
constexpr const char* kWidth = "lighting.width_mm";

Json scores(double even, double width) {
  return {{kEven, even}, {kWidth, width}};
}

Json member(int trial, double even, double width) {
  return {{"trial", trial}, {"scores", scores(even, width)}, {"rescored", scores(even, width)}};
}

/// Three designs, the middle one chosen; evenness upwards, width downwards.
Json trade() {
  Json winner = {{"key", "winner"},
                 {"title", "winner"},
                 {"scores", scores(0.8, 200)},
                 {"rescored", scores(0.8, 200)},
                 {"variables", Json::object()}};
  return {{"status", "done"},
          {"objective", {{"name", kEven}, {"sense", "maximise"}}},
          {"designs", {winner}},
          {"trials", {{{"number", 1}, {"failed", false}, {"feasible", true}, {"objective", 0.8}}}},
          {"front",
           {{"objectives",
             {{{"score", kEven}, {"direction", "maximise"}},
              {{"score", kWidth}, {"direction", "minimise"}}}},
            {"designs", {member(1, 0.7, 100), member(2, 0.8, 200), member(3, 0.9, 300)}},
            {"rescored", {{"designs", 3}}},
            {"outside", 0},
            {"chosen", {{"trial", 2}, {"by", "knee"}, {"reason", "the knee"}}}}}};
}

/// The text of a finding; empty: it is not there.
std::string finding(const Json& data, const std::string& code) {
  const Json report = complete_report(data);
  for (const Json& one : report["verdict"]["findings"]) {
    if (one["code"] == code) {
      return one["text"];
    }
  }
  return "";
}

TEST(FrontVerdict, SaysWhatTheCompromiseReachesAndWhyItWasChosen) {
  EXPECT_EQ(finding(trade(), "compromise"),
            "The compromise reaches h (rms) 80.0 %, width (mm) 200: the knee.");
  Json data = trade();
  data["designs"][0]["feasible"] = false;
  EXPECT_EQ(finding(data, "compromise"), "") << "the closest design is no compromise";
}

TEST(FrontVerdict, IsNotGoodWhenAPrototypeIsBetterInOneObjectiveAndWorseInNone) {
  const auto tone = [](const Json& data) { return complete_report(data)["verdict"]["tone"]; };
  Json data = trade();
  data["designs"].push_back({{"key", "dome"},
                             {"title", "Dome"},
                             {"scores", scores(0.9, 201)},
                             {"rescored", scores(0.9, 201)}});
  EXPECT_EQ(tone(data), "good") << "the dome is wider";
  data["designs"][1]["rescored"] = scores(0.9, 200);
  EXPECT_EQ(tone(data), "neutral");
  EXPECT_EQ(finding(data, "prototype_better"),
            "The prototype Dome is better in some objective and worse in none.");
  data["designs"][1]["feasible"] = false;
  EXPECT_EQ(tone(data), "good");
}

TEST(FrontVerdict, TellsWhatTheFrontSpans) {
  EXPECT_EQ(finding(trade(), "front_range"),
            "The front has 3 designs, h (rms) from 70.0 % to 90.0 %, width (mm) from 100 to 300.");
  // Fresh seeds count where there are any.
  Json data = trade();
  data["front"]["designs"][2]["rescored"][kEven] = 0.85;
  EXPECT_THAT(finding(data, "front_range"), HasSubstr("70.0 % to 85.0 %"));
  data["front"]["designs"] = Json::array({member(2, 0.8, 200)});
  EXPECT_EQ(finding(data, "front_range"), "");
}

TEST(FrontVerdict, TellsThatTheFrontIsOfExpectedValues) {
  EXPECT_EQ(finding(trade(), "front_expected"), "");
  Json data = trade();
  data["front"]["is_expected"] = true;
  EXPECT_THAT(finding(data, "front_expected"), HasSubstr("model expects of its designs"));
}

TEST(FrontVerdict, SaysWhetherTheFrontHoldsWithFreshSeeds) {
  EXPECT_THAT(finding(trade(), "front_holds"), HasSubstr("of 3 designs of the front none"));
  Json data = trade();
  data["front"]["designs"][2]["dominated_by"] = 1;
  EXPECT_EQ(finding(data, "front_holds"), "");
  EXPECT_THAT(finding(data, "front_shrinks"),
              HasSubstr("1 is beaten by another one (evaluation 3)"));
  data["front"]["designs"][0]["keeps_limits"] = false;
  EXPECT_THAT(finding(data, "front_shrinks"), HasSubstr("1 misses a limit (evaluation 1)"));
  data["front"]["rescored"] = nullptr;
  EXPECT_EQ(finding(data, "front_shrinks"), "") << "an older run";
}

TEST(FrontVerdict, IsNotGoodWhereTheCompromiseItselfIsBeaten) {
  Json data = trade();
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "good");
  EXPECT_EQ(finding(data, "compromise_dominated"), "");
  data["front"]["designs"][1]["dominated_by"] = 3;
  EXPECT_THAT(finding(data, "compromise_dominated"), HasSubstr("evaluation 3 is nowhere worse"));
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
}

/// trade() with a baseline that is behind in evenness and as wide, and a defect in both.
Json trade_with_baseline(double baseline_cnr, double winner_cnr) {
  Json data = trade();
  Json baseline = data["designs"][0];
  baseline["key"] = "baseline";
  baseline["title"] = "baseline";
  for (const char* list : {"scores", "rescored"}) {
    baseline[list] = scores(0.7, 200);
    baseline[list]["defects.min_cnr"] = baseline_cnr;
    data["designs"][0][list]["defects.min_cnr"] = winner_cnr;
  }
  data["designs"].push_back(baseline);
  return data;
}

TEST(FrontVerdict, IsNotGoodWhereTheCompromiseShowsTheDefectLess) {
  const auto tone = [](const Json& data) { return complete_report(data)["verdict"]["tone"]; };
  EXPECT_EQ(tone(trade_with_baseline(6.0, 7.0)), "good");
  const Json fainter = trade_with_baseline(6.0, 4.0);
  EXPECT_THAT(finding(fainter, "defects_fainter"), HasSubstr("smallest CNR 4.00 against 6.00"));
  EXPECT_EQ(tone(fainter), "neutral");
  EXPECT_EQ(tone(trade_with_baseline(1.0, 2.0)), "neutral") << "hidden in both";
}

TEST(FrontVerdict, IsNotGoodWhereTheCompromiseIsLevelWithTheBaseline) {
  Json data = trade_with_baseline(6.0, 7.0);
  data["designs"][1]["rescored"][kEven] = 0.8;
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
}

TEST(FrontVerdict, TellsOfAReferenceInsideTheFront) {
  Json data = trade();
  EXPECT_EQ(finding(data, "reference_inside"), "");
  data["front"]["outside"] = 2;
  EXPECT_THAT(finding(data, "reference_inside"), HasSubstr("2 of its 3 designs"));
}

}  // namespace
}  // namespace glint
