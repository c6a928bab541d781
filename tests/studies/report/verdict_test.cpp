// SPDX-License-Identifier: GPL-3.0-or-later
// Every sentence of a verdict has a code. For each code: data that trigger it, and data, changed
// in one thing, that do not.
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A design with CNR `cnr` and evenness 0.8, scored again with fresh seeds to the same values.
Json design_with(const std::string& key, double cnr) {
  const Json scores = {{"homogeneity.h_rms", 0.8},
                       {"homogeneity.lit_share", 1.0},
                       {"homogeneity.clipped_share", 0.0},
                       {"defects.made", 1},
                       {"defects.min_cnr", cnr}};
  return {{"key", key},
          {"title", key},
          {"feasible", true},
          {"scores", scores},
          {"rescored", scores},
          {"variables", {{"lighting.tunnel.radius_mm", 120.0}, {"sensor.gain", 2.0}}},
          {"defects", {{{"label", "dent"}, {"width_px", 8.0}}}}};
}

Json trial_with(int number, double cnr) {
  return {{"number", number},
          {"failed", false},
          {"feasible", true},
          {"objective", cnr},
          {"scores", {{"defects.min_cnr", cnr}, {"homogeneity.h_rms", 0.8}}}};
}

/// A sound search for the CNR of the worst defect: 5 before, 20 found, nothing on a limit.
Json sound_search() {
  return {{"title", "search"},
          {"status", "done"},
          {"objective", {{"name", "defects.min_cnr"}, {"sense", "maximise"}}},
          {"constraints", {{{"name", "homogeneity.h_rms"}, {"min", 0.7}}}},
          {"variables",
           {{{"name", "lighting.tunnel.radius_mm"},
             {"kind", "float"},
             {"low", 80},
             {"high", 160},
             {"log", false},
             {"unit", "mm"}},
            {{"name", "sensor.gain"},
             {"kind", "float"},
             {"low", 1},
             {"high", 3},
             {"log", false},
             {"unit", ""}}}},
          {"designs", {design_with("baseline", 5.0), design_with("winner", 20.0)}},
          {"trials",
           {trial_with(1, 5.0),
            trial_with(2, 7.0),
            trial_with(3, 9.0),
            trial_with(4, 12.0),
            trial_with(5, 20.0)}}};
}

/// Three prototypes without a search, scanned four times each with the same noise.
Json prototypes() {
  Json data = sound_search();
  data.erase("status");
  data["variables"] = Json::array();
  data["trials"] = Json::array();
  data["designs"] = {
      design_with("baseline", 5.0), design_with("dome", 9.0), design_with("bar", 7.0)};
  const std::vector<std::vector<double>> scans = {
      {5.1, 4.9, 5.0, 5.2}, {9.1, 8.9, 9.0, 9.2}, {7.1, 6.9, 7.0, 7.2}};
  for (std::size_t i = 0; i < scans.size(); ++i) {
    data["designs"][i]["repeated"]["defects.min_cnr"] = scans[i];
  }
  return data;
}

void set_cnr(Json& design, double cnr) {
  design["scores"]["defects.min_cnr"] = cnr;
  design["rescored"]["defects.min_cnr"] = cnr;
}

Json runs_with(int second_group) {
  Json runs = {{{"title", "a"},
                {"group", 0},
                {"differs", Json::array()},
                {"objective", {{"name", "defects.min_cnr"}, {"sense", "maximise"}}},
                {"feasible", true},
                {"scores", {{"defects.min_cnr", 5.0}}}}};
  runs.push_back(runs[0]);
  runs[1]["title"] = "b";
  runs[1]["group"] = second_group;
  runs[1]["scores"]["defects.min_cnr"] = 8.0;
  return {{"runs", runs}};
}

std::multiset<std::string> codes_of(const Json& data) {
  std::multiset<std::string> codes;
  const Json report = complete_report(data);
  for (const Json& finding : report["verdict"]["findings"]) {
    codes.insert(finding["code"].get<std::string>());
  }
  return codes;
}

std::string text_of_code(const Json& data, const std::string& code) {
  const Json report = complete_report(data);
  for (const Json& finding : report["verdict"]["findings"]) {
    if (finding["code"] == code) {
      return finding["text"].get<std::string>();
    }
  }
  return "";
}

/// A code, data that have it, and what to change so that it goes.
struct Case {
  std::string code;
  Json data;
  std::function<void(Json&)> mend;
};

Json changed(Json data, const std::function<void(Json&)>& change) {
  change(data);
  return data;
}

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
           mended}};
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

void repeat(Json& design, const std::vector<double>& scans) {
  design["repeated"]["defects.min_cnr"] = scans;
}

std::vector<Case> other_cases() {
  const Json two = changed(sound_search(), [](Json& d) {
    repeat(d["designs"][0], {4.0, 5.0, 6.0, 5.0});
    repeat(d["designs"][1], {20.0, 21.0, 19.0, 20.0});
  });
  const auto close = [](Json& d) { set_cnr(d["designs"][1], 5.5); };
  const auto as = [](const Json& other) { return [other](Json& data) { data = other; }; };
  const Json ranked = prototypes();
  const Json one = changed(ranked, [](Json& d) { d["designs"] = {design_with("only", 5.0)}; });
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

// A starter that made the gear more even and hid its dent: CNR 5.0 before, 3.1 after.
TEST(Verdict, IsNotGoodWhenTheWinnerHidesTheDefect) {
  Json data = sound_search();
  data["objective"]["name"] = "homogeneity.h_rms";
  data["designs"][1]["scores"]["homogeneity.h_rms"] = 0.9;
  data["designs"][1]["rescored"]["homogeneity.h_rms"] = 0.9;
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "good");
  set_cnr(data["designs"][1], 3.1);
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
  EXPECT_EQ(text_of_code(data, "defects_fainter"),
            "The worst defect shows less clearly than under the baseline (smallest CNR 3.1 "
            "against 5).");
}

/// The prototypes, ranked by evenness, in which the dome leads.
Json even_prototypes() {
  Json data = prototypes();
  data["objective"]["name"] = "homogeneity.h_rms";
  for (std::size_t i = 0; i < 3; ++i) {
    const double even = i == 1 ? 0.9 : 0.8;
    Json& design = data["designs"][i];
    design["repeated"] = {{"homogeneity.h_rms", {even, even + 0.001, even - 0.001}}};
    design["scores"]["homogeneity.h_rms"] = even;
    design["rescored"]["homogeneity.h_rms"] = even;
  }
  return data;
}

TEST(Verdict, OfARankingIsNotGoodWhenTheBestDesignShowsTheDefectLess) {
  Json data = even_prototypes();
  EXPECT_EQ(codes_of(data).count("ranking_sure"), 1U);
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "good");
  set_cnr(data["designs"][1], 4.0);
  EXPECT_EQ(codes_of(data).count("defects_fainter"), 1U);
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
  set_cnr(data["designs"][1], 9.0);
  data["designs"][1]["rescored"]["homogeneity.h_rms"] = 0.69;
  EXPECT_EQ(codes_of(data).count("limit_lost"), 1U);
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
}

TEST(Verdict, OfRunsIsGoodOnlyWhereTheLeadIsLargerThanTheNoise) {
  Json data = runs_with(0);
  const auto tone = [&] { return complete_report(data)["verdict"]["tone"]; };
  EXPECT_EQ(tone(), "good");
  data["runs"][1]["scores"]["defects.min_cnr"] = 5.0;
  EXPECT_THAT(complete_report(data)["verdict"]["sentence"].get<std::string>(),
              HasSubstr("level with b"));
  EXPECT_EQ(tone(), "neutral");
  data["runs"][1]["scores"]["defects.min_cnr"] = 6.0;
  repeat(data["runs"][0], {5.0, 7.0, 3.0, 5.0});
  repeat(data["runs"][1], {6.0, 3.0, 9.0, 6.0});
  EXPECT_EQ(tone(), "neutral");
}

TEST(Verdict, OfRunsIsNotGoodWhenTheBestOneShowsTheDefectLess) {
  Json data = runs_with(0);
  for (Json& run : data["runs"]) {
    run["objective"]["name"] = "homogeneity.h_rms";
    run["scores"]["homogeneity.h_rms"] = run["title"] == "a" ? 0.9 : 0.8;
  }
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
  EXPECT_EQ(text_of_code(data, "defects_fainter"),
            "In a the worst defect shows less clearly than under b (smallest CNR 5 against 8).");
  data["runs"][0]["scores"]["defects.min_cnr"] = 9.0;
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "good");
  EXPECT_EQ(text_of_code(data, "defects_fainter"), "");
}

// Ten evaluations: the five that meet every limit are alike, the others differ.
TEST(Verdict, TellsOfAnObjectiveThatIsFlatAmongDesignsThatMeetEveryLimit) {
  Json data = sound_search();
  data["trials"] = Json::array();
  for (int i = 0; i < 10; ++i) {
    data["trials"].push_back(trial_with(i + 1, i < 5 ? 1.0 : 2.0 + i));
    data["trials"][static_cast<std::size_t>(i)]["feasible"] = i < 5;
  }
  EXPECT_THAT(text_of_code(data, "objective_flat"),
              HasSubstr("5 of 5 evaluations that meet every limit have the same smallest CNR, 1"));
  data["trials"][0]["objective"] = 3.0;
  data["trials"][1]["objective"] = 4.0;
  EXPECT_EQ(text_of_code(data, "objective_flat"), "");
}

TEST(Verdict, TellsOfAHiddenDefectByAnyScoreOfItsKind) {
  Json data = sound_search();
  for (const char* name : {"defects.dent_1.cnr", "defects.min_dprime", "defects.dent_1.dprime"}) {
    data["objective"]["name"] = name;
    data["designs"][0]["scores"][name] = 0.2;
    data["designs"][1]["scores"][name] = 2.0;
    EXPECT_THAT(text_of_code(data, "defects_hidden"), HasSubstr("is 2 at most")) << name;
    data["designs"][1]["scores"][name] = 5.1;
    EXPECT_EQ(text_of_code(data, "defects_hidden"), "") << name;
  }
}

TEST(Verdict, CallsADesignLargerThanAllowedBySizesAlone) {
  Json data = sound_search();
  const auto on_limit = [&](const std::string& name) {
    data["variables"] = {
        {{"name", name}, {"kind", "float"}, {"low", 1}, {"high", 8}, {"unit", "mm"}}};
    data["designs"][1]["variables"] = {{name, 8.0}};
    return text_of_code(data, "on_limits");
  };
  EXPECT_EQ(on_limit("lighting.dome.radius_mm"),
            "The radius lies on its limit: the best design is larger than allowed.");
  for (const char* name : {"lighting.tunnel.period_mm",
                           "lighting.tunnel.slot_mm",
                           "lighting.bar.position_mm.1",
                           "part.position_mm.2",
                           "lighting.ring.height_mm"}) {
    EXPECT_THAT(on_limit(name), HasSubstr("a better design may lie beyond")) << name;
  }
}

TEST(Verdict, WithoutAnObjectiveTellsWhatHoldsForTheStudysOwnDesign) {
  Json data = prototypes();
  data.erase("objective");
  data["designs"][0]["rescored"]["homogeneity.lit_share"] = 0.6;
  data["designs"][0]["defects"][0]["width_px"] = 2.0;
  set_cnr(data["designs"][0], 1.0);
  EXPECT_EQ(text_of_code(data, "rendered"),
            "3 designs were rendered; no objective is set that would rank them. What follows is of "
            "baseline.");
  EXPECT_THAT(
      codes_of(data),
      ::testing::IsSupersetOf({"defects_shown", "defects_hidden", "dark_part", "narrow_defect"}));
}

TEST(Verdict, NamesTheVariablesThatLieOnTheirLimits) {
  Json data = sound_search();
  data["variables"] = Json::array();
  Json& values = data["designs"][1]["variables"];
  for (int i = 0; i < 5; ++i) {
    const std::string name = "lighting.tunnel.control_mm." + std::to_string(i);
    data["variables"].push_back(
        {{"name", name}, {"kind", "float"}, {"low", 60}, {"high", 250}, {"unit", "mm"}});
    values[name] = i == 2 ? 200.0 : 249.9;
  }
  EXPECT_EQ(text_of_code(data, "on_limits"),
            "4 of 5 control points lie on their limits: the best design is larger than allowed.");
  data["variables"].push_back({{"name", "lighting.tunnel.radius_mm"},
                               {"kind", "float"},
                               {"low", 80},
                               {"high", 160},
                               {"unit", "mm"}});
  values["lighting.tunnel.radius_mm"] = 160.0;
  EXPECT_EQ(text_of_code(data, "on_limits"),
            "4 of 5 control points and the radius lie on their limits: the best design is larger "
            "than allowed.");
  values["lighting.tunnel.radius_mm"] = 80.0;
  EXPECT_THAT(text_of_code(data, "on_limits"), HasSubstr("a better design may lie beyond them"));
}

// Differences of the scans: 15, 16, 13, 15; mean 14.75, deviation 1.258; Student's 97.5 % point of
// 3 degrees of freedom is 3.182, so 95 % of single differences lie within 3.182 x 1.258 = 4.00.
TEST(Verdict, TakesTheNoiseOfALeadFromScansThatShareIt) {
  Json data = sound_search();
  repeat(data["designs"][0], {5.0, 5.0, 6.0, 5.0});
  repeat(data["designs"][1], {20.0, 21.0, 19.0, 20.0});
  EXPECT_EQ(text_of_code(data, "lead_sure"),
            "The lead over the baseline is larger than the noise (4).");
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

TEST(VerdictOfRuns, RanksThoseThatBelongTogetherAndSaysWhatDiffers) {
  Json data = runs_with(0);
  data["runs"].push_back(data["runs"][0]);
  data["runs"][2]["title"] = "c";
  data["runs"][2]["group"] = 2;
  data["runs"][2]["differs"] = {"part (file)", "camera (width_px)"};
  const Json verdict = complete_report(data)["verdict"];
  EXPECT_EQ(verdict["sentence"],
            "These 3 runs are not ranked together: they do not all have the same part, camera, "
            "defects and objective.");
  EXPECT_EQ(verdict["details"][0], "Of 2 runs, b has the best smallest CNR: 8, 3 better than a.");
  EXPECT_EQ(verdict["details"][1], "c differs from a in part (file), camera (width_px).");
}

}  // namespace
}  // namespace glint
