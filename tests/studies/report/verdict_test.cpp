// SPDX-License-Identifier: GPL-3.0-or-later
// Every sentence of a verdict has a code. For each code: data that trigger it, and data, changed
// in one thing, that do not.
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "tests/studies/report/verdict_data.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

/// A code, data that have it, and what to change so that it goes.
struct Case {
  std::string code;
  Json data;
  std::function<void(Json&)> mend;
};

using Change = std::function<void(Json&)>;

/// A sound search, changed.
Json with(const Change& change) {
  return changed(sound_search(), change);
}

void mended(Json& data) {
  data = sound_search();
}

Change winner_at(double cnr) {
  return [cnr](Json& data) { set_cnr(data["designs"][1], cnr); };
}

std::vector<Case> search_cases() {
  const Json sound = sound_search();
  return {{"winner_better", sound, winner_at(5.0)},
          {"winner_level", with(winner_at(5.0)), mended},
          {"winner_worse", with(winner_at(4.0)), mended},
          {"winner_alone", with([](Json& d) { d["designs"].erase(0); }), mended},
          {"limits_met", sound, [](Json& d) { d["designs"][1]["feasible"] = false; }},
          {"no_feasible", with([](Json& d) { d["designs"][1]["feasible"] = false; }), mended},
          {"limit_failed",
           with([](Json& d) {
             d["designs"][1]["feasible"] = false;
             d["designs"][1]["scores"]["homogeneity.h_rms"] = 0.6;
           }),
           mended},
          {"limit_rate", with([](Json& d) { d["designs"][1]["feasible"] = false; }), mended},
          {"limit_lost",
           with([](Json& d) { d["designs"][1]["rescored"]["homogeneity.h_rms"] = 0.69; }),
           mended},
          {"limit_open",
           with([](Json& d) { d["designs"][1]["rescored"]["homogeneity.h_rms.error"] = 0.1; }),
           mended}};
}

/// The best design of a kind of light, scored again.
Json kind_of(const std::string& name, double cnr) {
  return {{"lighting_use", name},
          {"trial", 4},
          {"scores", {{"defects.min_cnr", 30.0}}},
          {"rescored", {{"defects.min_cnr", cnr}}},
          {"feasible", true}};
}

std::vector<Case> finding_cases() {
  const Json sound = sound_search();
  return {{"defects_clearer", sound, winner_at(4.0)},
          {"defects_fainter", with(winner_at(4.0)), mended},
          {"defects_level", with(winner_at(5.0)), mended},
          {"defects_hidden",
           with([](Json& d) {
             set_cnr(d["designs"][0], 0.3);
             set_cnr(d["designs"][1], 1.1);
           }),
           mended},
          {"no_defects",
           with([](Json& d) {
             d["objective"]["name"] = "homogeneity.h_rms";
             for (Json& design : d["designs"]) {
               for (const char* list : {"scores", "rescored"}) {
                 design[list].erase("defects.min_cnr");
                 design[list].erase("defects.made");
               }
             }
           }),
           mended},
          {"narrow_defect",
           with([](Json& d) { d["designs"][1]["defects"][0]["width_px"] = 2.9; }),
           [](Json& d) { d["designs"][1]["defects"][0]["width_px"] = 3.1; }},
          {"on_limits",
           with([](Json& d) { d["designs"][1]["variables"]["lighting.tunnel.radius_mm"] = 159.0; }),
           [](Json& d) { d["designs"][1]["variables"]["lighting.tunnel.radius_mm"] = 150.0; }},
          {"dark_part",
           with([](Json& d) { d["designs"][1]["rescored"]["homogeneity.lit_share"] = 0.6; }),
           mended},
          {"not_inspected",
           with([](Json& d) { d["designs"][1]["rescored"]["inspection.region_share"] = 0.8; }),
           [](Json& d) { d["designs"][1]["rescored"]["inspection.region_share"] = 1.0; }},
          {"kind_ahead",
           with([](Json& d) {
             d["designs"][1]["variables"]["lighting_use"] = "dome";
             d["kinds"] = {kind_of("ring", 25.0), kind_of("dome", 20.0)};
           }),
           [](Json& d) { d["designs"][1]["variables"]["lighting_use"] = "ring"; }},
          {"objective_flat",
           with([](Json& d) {
             for (std::size_t i = 0; i < 4; ++i) {
               d["trials"][i]["objective"] = 0.0;
             }
           }),
           [](Json& d) { d["trials"][0]["objective"] = 1.0; }},
          {"rescored", sound, [](Json& d) { d["designs"][1].erase("rescored"); }},
          {"interrupted", with([](Json& d) { d["status"] = "interrupted"; }), mended},
          {"budget", with([](Json& d) { d["status"] = "budget"; }), mended},
          {"all_failed",
           with([](Json& d) {
             d["designs"] = Json::array();
             for (Json& trial : d["trials"]) {
               trial["failed"] = true;
             }
           }),
           mended}};
}

std::vector<Case> other_cases() {
  const Json two = changed(sound_search(), [](Json& d) {
    repeat(d["designs"][0], {4.0, 5.0, 6.0, 5.0});
    repeat(d["designs"][1], {20.0, 21.0, 19.0, 20.0});
  });
  const auto close = [](Json& d) { set_cnr(d["designs"][1], 5.5); };
  const auto as = [](const Json& other) { return [other](Json& data) { data = other; }; };
  const Json ranked = prototypes();
  const Json one =
      changed(ranked, [](Json& d) { d["designs"] = Json::array({design_with("only", 5.0)}); });
  const auto scattered = [](Json& d) {
    repeat(d["designs"][1], {9.0, 5.0, 8.0, 6.5});
    repeat(d["designs"][2], {6.0, 8.0, 6.5, 7.9});
  };
  return {{"lead_sure", two, close},
          {"lead_open", changed(two, close), as(two)},
          {"ranked", ranked, as(one)},
          {"one_design", one, as(ranked)},
          {"defects_shown", one, as(ranked)},
          {"rendered", changed(one, [](Json& d) { d["objective"]["name"] = ""; }), as(one)},
          {"nothing_yet", Json::object(), as(one)},
          {"ranking_sure", ranked, scattered},
          {"ranking_open", changed(ranked, scattered), as(ranked)},
          {"runs_ranked", runs_with(0), as(runs_with(1))},
          {"runs_apart", runs_with(1), as(runs_with(0))},
          {"runs_infeasible",
           changed(runs_with(0),
                   [](Json& d) {
                     d["runs"][0]["feasible"] = false;
                     d["runs"][1]["feasible"] = false;
                   }),
           as(runs_with(0))},
          {"runs_differ",
           changed(runs_with(1), [](Json& d) { d["runs"][1]["differs"] = {"part (file)"}; }),
           as(runs_with(1))}};
}

void expect_triggered_and_not(const std::vector<Case>& cases) {
  for (const Case& one : cases) {
    EXPECT_GE(codes_of(one.data).count(one.code), 1U) << one.code << " is missing";
    EXPECT_EQ(codes_of(changed(one.data, one.mend)).count(one.code), 0U)
        << one.code << " is not to be there";
  }
}

TEST(VerdictCodes, OfASearchComeWithTheirCauseAndGoWithIt) {
  expect_triggered_and_not(search_cases());
  expect_triggered_and_not(finding_cases());
}

TEST(VerdictCodes, OfDesignsAndRunsComeWithTheirCauseAndGoWithIt) {
  expect_triggered_and_not(other_cases());
}

// 0.8 in the search and again; the limit is 0.7. Standard errors of 0.1 and 0.05 are one and two of
// the margin: 84.1 and 97.7 %.
TEST(VerdictCodes, SaysHowProbablyALimitIsKept) {
  Json data = sound_search();
  data["designs"][1]["rescored"]["homogeneity.h_rms.error"] = 0.1;
  EXPECT_THAT(text_of_code(data, "limit_open"),
              HasSubstr("h (rms) is 80.0 %, must be at least 70.0 %"));
  EXPECT_THAT(text_of_code(data, "limit_open"), HasSubstr("kept with a probability of 84 %."));
  data["constraints"][0]["max"] = 0.9;  // 84.1 % - 15.9 %
  EXPECT_THAT(text_of_code(data, "limit_open"), HasSubstr("a probability of 68 %"));
  data["constraints"][0].erase("max");
  data["designs"][1]["rescored"]["homogeneity.h_rms.error"] = 0.05;
  EXPECT_EQ(codes_of(data).count("limit_open"), 0U);
}

// The search's own order is dome, ring; scored again it is the other way round.
TEST(VerdictCodes, SaysWhichKindOfLightIsAheadOfTheWinners) {
  Json data = with([](Json& d) {
    d["designs"][1]["variables"]["lighting_use"] = "dome";
    d["kinds"] = {kind_of("ring", 25.0), kind_of("dome", 20.0)};
  });
  EXPECT_THAT(text_of_code(data, "kind_ahead"),
              HasSubstr("ring (evaluation 4: smallest CNR 25.0) comes before dome, the winner's "
                        "kind of light (evaluation 4: smallest CNR 20.0): which kind is better is "
                        "open."));
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
  data["race"] = {{"finalists", 2}};
  EXPECT_EQ(codes_of(data).count("kind_ahead"), 0U) << "the race knows more";
  for (Json& kind : data["kinds"]) {
    kind["rescored"]["defects.min_cnr.error"] = 0.5;
  }
  EXPECT_THAT(text_of_code(data, "kind_ahead"), HasSubstr("the lead is larger than the noise"));
  data["kinds"][0]["feasible"] = false;
  EXPECT_EQ(codes_of(data).count("kind_ahead"), 0U) << "none keeps the limits";
  std::swap(data["kinds"][0], data["kinds"][1]);
  EXPECT_EQ(codes_of(data).count("kind_ahead"), 0U);
}

TEST(VerdictCodes, StandInTheSentenceOrInTheDetails) {
  const Json verdict = complete_report(sound_search())["verdict"];
  std::string all = verdict["sentence"].get<std::string>();
  for (const Json& line : verdict["details"]) {
    all += line.get<std::string>();
  }
  for (const Json& finding : verdict["findings"]) {
    EXPECT_THAT(all, HasSubstr(finding["text"].get<std::string>()));
  }
}

TEST(Ranking, PutsDesignsThatMissALimitLastAndSaysWhich) {
  Json data = prototypes();
  data["designs"][1]["feasible"] = false;
  data["designs"][1]["scores"]["homogeneity.h_rms"] = 0.6;
  const Json ranking = complete_report(data)["ranking"];
  ASSERT_EQ(ranking.size(), 3U);
  EXPECT_EQ(ranking[0]["key"], "bar");
  EXPECT_EQ(ranking[1]["key"], "baseline");
  EXPECT_EQ(ranking[2]["key"], "dome");
  EXPECT_EQ(ranking[2]["missed"][0], "h (rms) is 60.0 %, must be at least 70.0 %");
  EXPECT_EQ(ranking[2]["probability_best"], 0.0);
  EXPECT_NEAR(ranking[0]["probability_best"].get<double>(), 1.0, 1e-9);
  EXPECT_THAT(text_of_code(data, "limit_failed"), HasSubstr("dome misses a limit"));
}

TEST(Ranking, ComparesWithDesignsThatMeetAllLimits) {
  Json data = prototypes();
  EXPECT_THAT(text_of_code(data, "ranking_sure"), HasSubstr("The next, bar, is 2.00 behind."));
  data["designs"].erase(0);
  data["designs"][0]["feasible"] = false;
  data["designs"][0]["scores"]["homogeneity.h_rms"] = 0.6;
  EXPECT_EQ(complete_report(data)["ranking"][0]["key"], "bar");
  EXPECT_EQ(text_of_code(data, "ranking_sure"),
            "With other noise bar would be the best 100 times of 100.");
}

// The mean of 5.1, 4.9, 5.0, 5.2 is 5.05, its standard error 0.1291 / 2 = 0.0645; times 3.182.
TEST(Ranking, GivesTheMeanOfTheScansWithItsInterval) {
  const Json last = complete_report(prototypes())["ranking"][2];
  EXPECT_EQ(last["key"], "baseline");
  EXPECT_NEAR(last["value"].get<double>(), 5.05, 1e-12);
  EXPECT_NEAR(last["low"].get<double>(), 5.05 - 0.2054, 1e-4);
  EXPECT_NEAR(last["high"].get<double>(), 5.05 + 0.2054, 1e-4);
}

// Two designs alike but for independent noise: over many studies the chances are even, and what one
// has the other lacks. Shared noise cancels: a lead of a tenth of it is sure.
TEST(Ranking, SharesTheChanceOfBeingBestAndUsesThatNoiseIsCommon) {
  Rng rng(3, Stream::kTest, 0);
  double sum = 0.0;
  constexpr int kStudies = 200;
  Json data = prototypes();
  data["designs"].erase(2);
  for (int study = 0; study < kStudies; ++study) {
    std::vector<double> a;
    std::vector<double> b;
    for (int k = 0; k < 8; ++k) {
      a.push_back(5.0 + rng.normal());
      b.push_back(5.0 + rng.normal());
    }
    repeat(data["designs"][0], a);
    repeat(data["designs"][1], b);
    const Json ranking = complete_report(data)["ranking"];
    const double first = ranking[0]["probability_best"].get<double>();
    ASSERT_NEAR(first + ranking[1]["probability_best"].get<double>(), 1.0, 1e-9);
    sum += ranking[0]["key"] == "baseline" ? first : 1.0 - first;
    for (std::size_t k = 0; k < a.size(); ++k) {
      b[k] = a[k] + 0.1;
    }
    repeat(data["designs"][1], b);
    ASSERT_NEAR(complete_report(data)["ranking"][0]["probability_best"].get<double>(), 1.0, 1e-9);
  }
  EXPECT_NEAR(
      sum / kStudies, 0.5, 0.1);  // the chances are spread evenly: deviation 0.3 / sqrt(200)
}

// Where every design scores 0 none has "the best" of it.
TEST(Ranking, OfLevelDesignsNamesNoBest) {
  const Json level = changed(prototypes(), [](Json& d) {
    for (Json& design : d["designs"]) {
      set_cnr(design, 0.0);
      repeat(design, {0.0, 0.0, 0.0, 0.0});
    }
    d["designs"][1]["feasible"] = false;
    d["designs"][1]["scores"]["homogeneity.h_rms"] = 0.6;
  });
  EXPECT_EQ(text_of_code(level, "objective_flat"),
            "All 3 designs have the same smallest CNR, 0: it does not tell them apart.");
  EXPECT_THAT(text_of_code(level, "limit_failed"), HasSubstr("dome misses a limit"));
  for (const char* code : {"ranked", "ranking_open", "ranking_sure"}) {
    EXPECT_EQ(codes_of(level).count(code), 0U) << code;
  }
  EXPECT_EQ(codes_of(prototypes()).count("objective_flat"), 0U);
}

TEST(Ranking, IsOfDesignsWithoutASearchAlone) {
  EXPECT_FALSE(complete_report(sound_search()).contains("ranking"));
  const Json complete = complete_report(prototypes());
  EXPECT_EQ(complete["ranking"][0]["key"], "dome");
  EXPECT_EQ(complete["panels"][0]["id"], "ranking");
  EXPECT_EQ(complete_report(complete), complete);
}

}  // namespace
}  // namespace glint
