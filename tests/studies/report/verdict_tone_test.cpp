// SPDX-License-Identifier: GPL-3.0-or-later
//
// When a verdict is good, and what its sentences say.
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/studies/report/verdict_data.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

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
            "The worst defect shows less clearly than under the baseline (smallest CNR "
            "3.10 against 5.00).");
}

/// A search with a prototype beside: CNR 5 before, 20 found.
Json search_beside(double cnr_of_prototype) {
  Json data = sound_search();
  data["designs"].push_back(design_with("dome", cnr_of_prototype));
  return data;
}

TEST(Verdict, IsNotGoodWhenAPrototypeThatMeetsTheLimitsIsAhead) {
  EXPECT_EQ(complete_report(search_beside(19.0))["verdict"]["tone"], "good");
  EXPECT_EQ(codes_of(search_beside(19.0)).count("prototype_better"), 0U);
  Json data = search_beside(30.0);
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
  EXPECT_EQ(text_of_code(data, "prototype_better"),
            "The search has found nothing as good as the best prototype, dome.");
  data["designs"][2]["feasible"] = false;
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "good");
  EXPECT_EQ(text_of_code(data, "winner_better"),
            "The winner reaches smallest CNR 20.0: 15.0 better than the baseline and 10.0 worse "
            "than the best prototype, dome (which misses a limit).");
}

TEST(Verdict, SaysOfABaselineThatItMissesALimit) {
  Json data = sound_search();
  data["designs"][0]["feasible"] = false;
  EXPECT_THAT(text_of_code(data, "winner_better"),
              HasSubstr("15.0 better than the baseline (which misses a limit)."));
}

// Differences of the scans to the dome's: -1, 1, 1, -1, whose deviation is 1.155: the noise of a
// single one is 3.182 x 1.155 = 3.67.
TEST(Verdict, TellsTheNoiseOfALeadOverThePrototype) {
  Json data = search_beside(19.5);
  repeat(data["designs"][1], {20.0, 21.0, 21.0, 20.0});
  repeat(data["designs"][2], {21.0, 20.0, 20.0, 21.0});
  EXPECT_EQ(text_of_code(data, "lead_open"),
            "The lead over the best prototype is not larger than the noise (3.67): it may "
            "be chance; more parts or scans would show.");
  set_cnr(data["designs"][2], 20.5);
  EXPECT_THAT(text_of_code(data, "lead_open"), HasSubstr("The lead of the best prototype is"));
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "good") << "chance may have put it ahead";
  set_cnr(data["designs"][2], 10.0);
  EXPECT_EQ(text_of_code(data, "lead_sure"),
            "The lead over the best prototype is larger than the noise (3.67).");
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
            "In a the worst defect shows less clearly than under b (smallest CNR 5.00 against "
            "8.00).");
  data["runs"][0]["scores"]["defects.min_cnr"] = 9.0;
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "good");
  EXPECT_EQ(text_of_code(data, "defects_fainter"), "");
}

TEST(Verdict, OfRunsIsNotGoodWhenTheOnlyFeasibleOneHidesTheDefect) {
  Json data = runs_with(0);
  data["runs"][0]["feasible"] = false;
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "good");
  data["runs"][1]["scores"]["defects.min_cnr"] = 0.2;
  EXPECT_EQ(codes_of(data).count("defects_hidden"), 1U);
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
}

TEST(Verdict, OfRunsKnowsAllDesignsThatMayShowTheDefect) {
  Json data = runs_with(0);
  data["runs"][0]["scores"]["defects.min_cnr"] = 0.1;
  data["runs"][1]["scores"]["defects.min_cnr"] = 0.2;
  EXPECT_THAT(text_of_code(data, "defects_hidden"), HasSubstr("No design here shows"));
  Json shown = design_with("dome", 9.0);
  shown["run"] = "a";
  data["designs"] = Json::array({shown});
  EXPECT_THAT(text_of_code(data, "defects_hidden"), HasSubstr("another design reached 9.00"));
  data["designs"][0]["run"] = "c";
  EXPECT_THAT(text_of_code(data, "defects_hidden"), HasSubstr("No design here shows"));
}

TEST(Verdict, OfRunsWithoutAnObjectiveIsThatTheyWereRendered) {
  Json data = runs_with(0);
  for (Json& run : data["runs"]) {
    run.erase("objective");
  }
  const Json verdict = complete_report(data)["verdict"];
  EXPECT_EQ(verdict["sentence"], "2 runs were rendered; no objective is set that would rank them.");
  EXPECT_EQ(verdict["tone"], "neutral");
  Json other = runs_with(1)["runs"][1];
  other["title"] = "c";
  data["runs"].push_back(other);
  data["objective"] = other["objective"];
  EXPECT_THAT(text_of_code(data, "rendered"), HasSubstr("2 runs were rendered"));
}

TEST(Verdict, OfRunsIsNotGoodWhenItsOwnReportDoubtsTheBestOne) {
  Json data = runs_with(0);
  const Json doubts = {{{"code", "limit_lost"}, {"text", "It is lost."}}};
  data["runs"][0]["doubts"] = doubts;
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "good") << "b is the best one";
  data["runs"][1]["doubts"] = doubts;
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
  EXPECT_EQ(text_of_code(data, "limit_lost"), "Of b: It is lost.");
}

// Ten evaluations: the five that meet every limit are alike, the others differ.
TEST(Verdict, TellsOfAnObjectiveThatIsFlatAmongDesignsThatMeetEveryLimit) {
  Json data = sound_search();
  data["trials"] = Json::array();
  for (int i = 0; i < 10; ++i) {
    data["trials"].push_back(trial_with(i + 1, i < 5 ? 1.0 : 2.0 + i));
    data["trials"][static_cast<std::size_t>(i)]["feasible"] = i < 5;
  }
  EXPECT_THAT(
      text_of_code(data, "objective_flat"),
      HasSubstr("5 of 5 evaluations that meet every limit have the same smallest CNR, 1.00"));
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
    EXPECT_THAT(text_of_code(data, "defects_hidden"), HasSubstr("is 2.00 at most")) << name;
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

// The same numbers as in page_words.mjs: terminal and page write them alike.
TEST(Verdict, WritesNumbersAsThePageDoes) {
  const std::vector<std::pair<double, std::string>> expected = {
      {13.0, "13.0"},
      {12.34, "12.3"},
      {9.006, "9.01"},
      {0.38, "0.380"},
      {8.614e-4, "0.000861"},
      {0.0, "0"},
      {-2.5, "\u22122.50"},
      {9.996, "10.0"},
      {999.6, "1000"},
      {12.25, "12.3"},
      {1234.5, "1235"},
      {99999.5, "100000"},
      {1e6, "1.00\u00a0\u00d7\u00a010\u2076"},
      {5.123e-6, "5.12\u00a0\u00d7\u00a010\u207b\u2076"}};
  Json data = prototypes();
  data["designs"].erase(2);
  data["designs"].erase(1);
  for (const auto& [value, text] : expected) {
    set_cnr(data["designs"][0], value);
    EXPECT_EQ(text_of_code(data, "one_design"), "The design reaches smallest CNR " + text + ".");
  }
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
  for (int i = 0; i < 5; ++i) {
    values["lighting.tunnel.control_mm." + std::to_string(i)] = 100.0;
  }
  values["lighting.tunnel.radius_mm"] = 120.0;
  data["variables"].push_back(
      {{"name", "sensor.gain"}, {"kind", "float"}, {"low", 1}, {"high", 3}});
  values["sensor.gain"] = 3.0;
  EXPECT_EQ(text_of_code(data, "on_limits"),
            "The gain lies on its limit: a better design may lie beyond it.");
}

// Two rings have a radius each; of the segments' powers, of which only one has any, two of two lie
// at their max.
TEST(Verdict, NamesTheLightsWhoseVariablesOfOneNameLieOnTheirLimits) {
  Json data = sound_search();
  data["variables"] = Json::array();
  Json& values = data["designs"][1]["variables"];
  const auto add = [&](const std::string& name, double value) {
    data["variables"].push_back({{"name", name}, {"kind", "float"}, {"low", 40}, {"high", 80}});
    values[name] = value;
  };
  add("lighting.left_ring.outer_radius_mm", 80.0);
  add("lighting.right_ring.outer_radius_mm", 60.0);
  EXPECT_EQ(text_of_code(data, "on_limits"),
            "The outer radius of left_ring lies on its limit: the best design is larger than "
            "allowed.");
  values["lighting.right_ring.outer_radius_mm"] = 80.0;
  add("lighting.right_ring.segment_power.0", 80.0);
  add("lighting.right_ring.segment_power.1", 80.0);
  EXPECT_EQ(text_of_code(data, "on_limits"),
            "The outer radius of left_ring, the outer radius of right_ring and both segment "
            "powers lie on their limits: a better design may lie beyond them.");
}

TEST(Verdict, OfASearchThatFailedTellsWhatTheBestDesignThatWasSetShows) {
  Json data = sound_search();
  data["designs"] = Json::array({design_with("baseline", 5.0), design_with("dome", 7.0)});
  for (Json& trial : data["trials"]) {
    trial["failed"] = true;
  }
  EXPECT_EQ(text_of_code(data, "all_failed"), "All 5 evaluations failed; the reasons are below.");
  EXPECT_EQ(text_of_code(data, "defects_clearer"),
            "Of dome: The worst defect shows more clearly than under the baseline (smallest CNR "
            "7.00 against 5.00).");
  data["designs"].erase(1);
  EXPECT_EQ(text_of_code(data, "defects_shown"),
            "Of baseline: The worst defect: smallest CNR 5.00.");
}

// Without a dark share before it, "of it" would be of nothing.
TEST(Verdict, SaysWhatIsAtFullScale) {
  Json data = sound_search();
  Json& fresh = data["designs"][1]["rescored"];
  fresh["homogeneity.clipped_share"] = 0.25;
  EXPECT_EQ(text_of_code(data, "dark_part"),
            "25.0 % of the scored surface is at full scale in every frame: no defect can show "
            "there.");
  fresh["homogeneity.lit_share"] = 0.6;
  EXPECT_EQ(text_of_code(data, "dark_part"),
            "40.0 % of the scored surface is dark, 25.0 % of it is at full scale in every frame: "
            "no defect can show there.");
}

// Differences of the scans: 15, 16, 13, 15; mean 14.75, deviation 1.258; Student's 97.5 % point of
// 3 degrees of freedom is 3.182, so 95 % of single differences lie within 3.182 x 1.258 = 4.00.
TEST(Verdict, TakesTheNoiseOfALeadFromScansThatShareIt) {
  Json data = sound_search();
  repeat(data["designs"][0], {5.0, 5.0, 6.0, 5.0});
  repeat(data["designs"][1], {20.0, 21.0, 19.0, 20.0});
  EXPECT_EQ(text_of_code(data, "lead_sure"),
            "The lead over the baseline is larger than the noise (4.00).");
}

TEST(VerdictOfRuns, RanksThoseThatBelongTogetherAndSaysWhatDiffers) {
  Json data = runs_with(0);
  data["runs"].push_back(data["runs"][0]);
  data["runs"][2]["title"] = "c";
  data["runs"][2]["group"] = 2;
  data["runs"][2]["differs"] = {"part (file)", "camera (width_px)"};
  const Json verdict = complete_report(data)["verdict"];
  EXPECT_EQ(verdict["sentence"],
            "These 3 runs are not ranked together: they do not all have the same part, material, "
            "camera, defects, scored region, inspection, objective and what that is measured by.");
  EXPECT_EQ(verdict["details"][0],
            "Of 2 runs, b has the best smallest CNR: 8.00, 3.00 better than a.");
  EXPECT_EQ(verdict["details"][1], "c differs from a in part (file), camera (width_px).");
}

TEST(Verdict, SaysOfAHiddenDefectByHowLittleItIs) {
  Json data = sound_search();
  for (Json& trial : data["trials"]) {
    trial["scores"]["defects.min_cnr"] = 1.0;
  }
  set_cnr(data["designs"][0], 1.0);
  set_cnr(data["designs"][1], 2.998);
  EXPECT_THAT(text_of_code(data, "defects_hidden"), HasSubstr("is 2.998 at most, and below 3"));
}

TEST(Verdict, CallsLevelWhatReadsTheSame) {
  Json data = sound_search();
  data["objective"]["name"] = "homogeneity.h_rms";
  const auto sentence = [&](double before, double after) {
    data["designs"][0]["rescored"]["homogeneity.h_rms"] = before;
    data["designs"][1]["rescored"]["homogeneity.h_rms"] = after;
    return complete_report(data)["verdict"]["sentence"].get<std::string>();
  };
  EXPECT_THAT(sentence(0.8486, 0.8494), HasSubstr("84.9 %: level with the baseline"));
  EXPECT_THAT(sentence(0.8494, 0.8496), HasSubstr("85.0 %: 0.02 points better than"));
  data["objective"]["name"] = "defects.min_cnr";
  set_cnr(data["designs"][0], 12.81);
  set_cnr(data["designs"][1], 12.84);
  EXPECT_EQ(codes_of(data).count("winner_level"), 1U);
}

}  // namespace
}  // namespace glint
