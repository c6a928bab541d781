// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report.h"

#include <cctype>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "core/rng.h"
#include "tests/support/page_data.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using test::page_data;
using test::page_text;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Json report_design(const std::string& key, double h_rms, bool is_feasible = true) {
  return {{"key", key}, {"feasible", is_feasible}, {"scores", {{"homogeneity.h_rms", h_rms}}}};
}

/// A finished search with baseline, two prototypes and a winner.
Json search_report() {
  Json winner = report_design("winner", 0.970);
  winner["rescored"] = {{"homogeneity.h_rms", 0.966}};
  return {{"title", "tunnel_shape"},
          {"status", "done"},
          {"objective", {{"name", "homogeneity.h_rms"}, {"sense", "maximise"}}},
          {"constraints", Json::array({Json{{"name", "defects.cnr_min"}, {"min", 3}}})},
          {"designs",
           {report_design("baseline", 0.839),
            report_design("flat", 0.856),
            report_design("ellipse", 0.910),
            winner}},
          {"trials",
           {{{"number", 0},
             {"feasible", true},
             {"objective", 0.9},
             {"scores", {{"defects.cnr_min", 4}}}},
            {{"number", 1}, {"failed", true}, {"message", "the slot is wider than the tunnel"}}}}};
}

std::string sentence_of(const Json& data) {
  return complete_report(data)["verdict"]["sentence"].get<std::string>();
}

TEST(RenderReport, HoldsTheCompletedData) {
  const Json data = search_report();
  EXPECT_EQ(page_data(render_report(data)), complete_report(data));
}

TEST(RenderReport, CannotBeLeftThroughATextOfTheData) {
  Json data = search_report();
  const std::string attack = "</script><script>alert(1)</script><!--";
  data["title"] = attack;
  data["trials"][1]["message"] = attack;
  const std::string page = render_report(data);
  EXPECT_THAT(page, Not(HasSubstr("<script>alert(1)")));
  EXPECT_EQ(page_data(page)["trials"][1]["message"], attack);
  EXPECT_THAT(page, HasSubstr("<title>&lt;/script&gt;&lt;script&gt;alert(1)"));
}

TEST(RenderReport, TakesNoTextForAMarkOfThePage) {
  const std::string title = "@GLINT_DATA@ @GLINT_TITLE@";
  const std::string page = render_report({{"title", title}});
  EXPECT_EQ(page_data(page)["title"], title);
  EXPECT_THAT(page, HasSubstr("<title>" + title));
}

/// The first thing a page would fetch from elsewhere; empty when there is none.
std::string fetched_by(const std::string& page) {
  std::string plain;
  for (const char c : page) {
    if (std::string_view(" \"'\n").find(c) == std::string_view::npos) {
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  for (const char* mark : {"src=", "href=", "url("}) {
    for (const char* place : {"http:", "https:", "//"}) {
      const auto at = plain.find(std::string(mark) + place);
      if (at != std::string::npos) {
        return plain.substr(at, 60);
      }
    }
  }
  return plain.find("@import") == std::string::npos ? "" : "@import";
}

TEST(RenderReport, FetchesNothing) {
  const std::string page = render_report(search_report());
  EXPECT_EQ(fetched_by(page), "");
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy\" content=\"default-src 'none'"));
  EXPECT_EQ(fetched_by("<img SRC = \"https://example.org\">"), "src=https://example.org>");
  EXPECT_EQ(fetched_by("a{background:url( '//x.org')}"), "url(//x.org)}");
}

TEST(RenderReport, KeepsTheLicencesOfWhatItContains) {
  const std::string page = render_report(search_report());
  EXPECT_THAT(page, HasSubstr("Apache ECharts"));
  EXPECT_THAT(page, HasSubstr("Copyright 2017-2026 The Apache Software Foundation"));
  EXPECT_THAT(page, HasSubstr("TERMS AND CONDITIONS FOR USE, REPRODUCTION, AND DISTRIBUTION"));
  EXPECT_THAT(page, HasSubstr("Copyright (c) 2017, Baidu Inc."));
}

TEST(RenderReport, IsSmallWithoutPictures) {
  const std::size_t bytes = render_report(search_report()).size();
  EXPECT_LT(bytes, 1'500'000U);
  EXPECT_GT(bytes, 300'000U);  // the charts are in it
}

TEST(RenderReport, IsTheSameForTheSameData) {
  EXPECT_EQ(render_report(search_report()), render_report(search_report()));
}

TEST(RenderReport, TurnsNumbersThatAreNotFiniteIntoGaps) {
  Json data = search_report();
  data["trials"][0]["objective"] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(page_data(render_report(data))["trials"][0]["objective"].is_null());
}

TEST(RenderReport, SurvivesBrokenUtf8) {
  Json data = search_report();
  data["trials"][1]["message"] = "file \xff\xfe.stl";
  EXPECT_THAT(page_text(render_report(data)), HasSubstr("file \xEF\xBF\xBD"));
}

// 96.6 % - 83.9 % = 12.7 points, 96.6 % - 91.0 % = 5.6 points.
TEST(CompleteReport, ComparesTheWinnersFreshNumbersWithBaselineAndBestPrototype) {
  EXPECT_EQ(
      sentence_of(search_report()),
      "The winner reaches h (rms) 96.6 %: 12.7 points better than the baseline and 5.6 points "
      "better than the best prototype, ellipse. It meets the constraint.");
  EXPECT_THAT(complete_report(search_report())["verdict"]["details"].dump(),
              AllOf(HasSubstr("96.6 %"), HasSubstr("97.0 %")));
}

TEST(CompleteReport, SaysSoWhenTheWinnerIsWorseOrLevel) {
  Json data = search_report();
  data["designs"][3]["rescored"]["homogeneity.h_rms"] = 0.839;
  const std::string sentence = sentence_of(data);
  EXPECT_THAT(sentence, HasSubstr("level with the baseline"));
  EXPECT_THAT(sentence, HasSubstr("7.1 points worse than the best prototype, ellipse"));
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "neutral");
}

TEST(CompleteReport, KnowsThatLessIsBetterWhenMinimising) {
  Json data = search_report();
  data["objective"]["sense"] = "minimise";
  data["designs"][3]["rescored"]["homogeneity.h_rms"] = 0.80;
  EXPECT_THAT(sentence_of(data),
              HasSubstr("3.9 points better than the baseline and 5.6 points better "
                        "than the best prototype, flat"));
}

TEST(CompleteReport, PrefersAFeasiblePrototypeToABetterInfeasibleOne) {
  Json data = search_report();
  data["designs"][2]["feasible"] = false;
  EXPECT_THAT(sentence_of(data), HasSubstr("the best prototype, flat"));
}

TEST(CompleteReport, NamesAnInfeasibleWinnerForWhatItIs) {
  Json data = search_report();
  data["designs"][3]["feasible"] = false;
  EXPECT_THAT(sentence_of(data), HasSubstr("No design meets every constraint"));
  EXPECT_EQ(complete_report(data)["verdict"]["tone"], "bad");
}

TEST(CompleteReport, CountsWhichConstraintsWereMetWhenNothingIsFeasible) {
  Json data = search_report();
  data["designs"] = Json::array();
  data["status"] = "interrupted";
  const Json verdict = complete_report(data)["verdict"];
  EXPECT_EQ(verdict["sentence"], "No feasible design in 2 evaluations.");
  EXPECT_THAT(verdict["details"][0].get<std::string>(),
              HasSubstr("interrupted after 2 evaluations"));
  EXPECT_EQ(verdict["details"][1], "smallest CNR: within its limit in 1 of 2 evaluations.");
}

TEST(CompleteReport, SaysThatEveryEvaluationFailed) {
  Json data = search_report();
  data["designs"] = Json::array();
  data["trials"].erase(0);
  EXPECT_EQ(sentence_of(data), "The only evaluation failed; its reason is below.");
}

TEST(CompleteReport, DescribesDesignsWithoutASearch) {
  Json data = search_report();
  data["trials"] = Json::array();
  data["designs"] = Json::array({report_design("scene", 0.9, false)});
  EXPECT_EQ(sentence_of(data),
            "The design reaches h (rms) 90.0 %. It does not meet every constraint.");
  data["designs"].push_back(report_design("other", 0.8));
  EXPECT_THAT(sentence_of(data), HasSubstr("Of 2 designs, other has the best h (rms): 80.0 %."));
  EXPECT_EQ(sentence_of(Json::object()), "There is no result yet.");
}

// 93.8 % - 91.8 % = 2.0 points; the infeasible run does not count.
TEST(CompleteReport, RanksRuns) {
  Json data = {{"objective", {{"name", "homogeneity.h_rms"}}}};
  const auto run = [](const char* title, double value, bool is_feasible) {
    return Json{
        {"title", title}, {"feasible", is_feasible}, {"scores", {{"homogeneity.h_rms", value}}}};
  };
  data["runs"] = {run("flat", 0.918, true), run("free", 0.938, true), run("odd", 0.99, false)};
  EXPECT_EQ(sentence_of(data),
            "Of 3 runs, free has the best h (rms): 93.8 %, 2.0 points better than flat.");
}

TEST(CompleteReport, LeavesAGivenVerdictAlone) {
  Json data = search_report();
  data["verdict"] = {{"sentence", "As told."}};
  EXPECT_EQ(sentence_of(data), "As told.");
}

TEST(CompleteReport, LabelsScoresAndKnowsWhichArePerCent) {
  Json data = search_report();
  data["designs"][0]["scores"] = {{"homogeneity.h_abs", 0.9},
                                  {"homogeneity.clipped_share", 0.01},
                                  {"defects.cnr_min", 3.5},
                                  {"defects.dent.signature_area_ratio", 6.1}};
  data["score_info"]["homogeneity.clipped_share"] = {{"label", "clipped"}, {"format", "number"}};
  const Json info = complete_report(data)["score_info"];
  EXPECT_EQ(info["homogeneity.h_abs"]["label"], "h (abs)");
  EXPECT_EQ(info["homogeneity.h_abs"]["format"], "percent");
  EXPECT_THAT(info["homogeneity.h_abs"]["meaning"].get<std::string>(),
              HasSubstr("1 - mean absolute deviation / mean"));
  EXPECT_EQ(info["defects.cnr_min"], (Json{{"label", "smallest CNR"}, {"format", "number"}}));
  EXPECT_EQ(info["defects.dent.signature_area_ratio"]["label"], "dent: signature area ratio");
  EXPECT_EQ(info["homogeneity.clipped_share"]["label"], "clipped");
}

TEST(CompleteReport, CallsScoresByWords) {
  Json scores = Json::object();
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"homogeneity.h_rms", "h (rms)"},
      {"homogeneity.h_rms.low", "h (rms), lower bound"},
      {"homogeneity.h_rms.error", "h (rms), standard error"},
      {"homogeneity.clipped_share", "clipped share"},
      {"defects.min_dprime", "smallest d'"},
      {"defects.min_cnr", "smallest CNR"},
      {"defects.mean_weber", "mean Weber contrast"},
      {"defects.min_rms_contrast", "smallest RMS contrast"},
      {"defects.mean_depth_um", "mean depth (\u00b5m)"},
      {"defects.removed_volume_mm3", "removed volume (mm\u00b3)"},
      {"defects.dent_1.weber", "dent_1: Weber contrast"},
      {"defects.dent_1.union", "dent_1: area that changes"},
      {"inspection.smallest_slope_mrad", "smallest slope (mrad)"},
      {"inspection.dents.auc", "dents: AUC"},
      {"view.slot_margin_mm", "slot margin (mm)"},
      {"weber", "Weber contrast"}};
  for (const auto& [name, label] : expected) {
    scores[name] = 0.5;
  }
  const Json info =
      complete_report({{"designs", {{{"key", "a"}, {"scores", scores}}}}})["score_info"];
  for (const auto& [name, label] : expected) {
    EXPECT_EQ(info[name]["label"], label);
    EXPECT_FALSE(info[name].value("meaning", "").empty()) << name;
  }
}

// Another run of the same study differs in its element alone.
TEST(RenderReport, HasDateAndDurationInOneElementOnly) {
  Json data = search_report();
  const std::string without = render_report(data);
  data["when"] = "2026-11-23 08:10:05 UTC, <1 min";
  const std::string with = render_report(data);
  EXPECT_THAT(with, HasSubstr("<span id=\"when\">2026-11-23 08:10:05 UTC, &lt;1 min</span>"));
  EXPECT_NE(with, without);
  EXPECT_EQ(test::without_when(with), test::without_when(without));
  EXPECT_THAT(page_text(with), Not(HasSubstr("2026")));
}

TEST(CompleteReport, NeverCallsAWorseWinnerBetter) {
  Rng rng(11, Stream::kTest, 0);
  for (int round = 0; round < 1000; ++round) {
    Json data = search_report();
    const double winner = rng.uniform();
    const double baseline = rng.uniform();
    data["designs"] = {report_design("baseline", baseline), report_design("winner", winner)};
    const bool is_minimised = rng.uniform() < 0.5;
    data["objective"]["sense"] = is_minimised ? "minimise" : "maximise";
    const std::string sentence = sentence_of(data);
    const double gain = is_minimised ? baseline - winner : winner - baseline;
    const std::string right = gain > 0 ? "better than" : "worse than";
    const std::string wrong = gain > 0 ? "worse than" : "better than";
    const bool is_clear = std::abs(gain) > 0.001;  // more than what may be level in print
    ASSERT_THAT(sentence, Not(HasSubstr(wrong))) << winner << " against " << baseline;
    ASSERT_THAT(sentence, HasSubstr(is_clear ? right : "h (rms)")) << winner;
  }
}

/// Bytes 16 to 23 of a PNG: width and height, big-endian. Base64 holds 3 bytes in 4 letters.
std::pair<int, int> png_size(const std::string& base64_text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  for (std::size_t i = 0; i + 4 <= base64_text.size() && bytes.size() < 24; i += 4) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      group = group << 6U | static_cast<unsigned>(letters.find(base64_text[i + k]) & 63U);
    }
    for (const unsigned shift : {16U, 8U, 0U}) {
      bytes += static_cast<char>(group >> shift & 255U);
    }
  }
  const auto at = [&](std::size_t i) {
    return static_cast<int>(static_cast<unsigned char>(bytes.at(i)));
  };
  return {at(18) * 256 + at(19), at(22) * 256 + at(23)};
}

// 1300 px in at most 500 px: factor 3, 1300 / 3 = 433 and 300 / 3 = 100 whole pixels.
TEST(ReportPng, IsReducedByTheSmallestFactorThatFits) {
  EXPECT_EQ(png_size(report_png(ImageF(1300, 300, 0.5F), 500)), std::pair(433, 100));
  EXPECT_EQ(png_size(report_png(ImageF(400, 300, 0.5F), 400)), std::pair(400, 300));
  EXPECT_EQ(png_size(report_png(ImageF(1000, 1, 0.5F), 100)), std::pair(1000, 1));
}

ImageF ramp_image() {
  ImageF image(8, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 8; ++x) {
      image(x, y) = static_cast<float>(10 * y + x);
    }
  }
  return image;
}

TEST(Closeup, CutsASquareAndMovesItInwardsAtTheRim) {
  const ImageF inside = closeup(ramp_image(), 3, 2, 1);
  ASSERT_EQ(inside.width(), 3);
  ASSERT_EQ(inside.height(), 3);
  EXPECT_EQ(inside(0, 0), 12.0F);
  EXPECT_EQ(inside(2, 2), 34.0F);
  EXPECT_EQ(closeup(ramp_image(), 7, 0, 1)(0, 0), 5.0F);  // columns 5..7, rows 0..2
  const ImageF all = closeup(ramp_image(), -20, 90, 9);
  EXPECT_EQ(all, ramp_image());
}

// (0.4 - 0.2) / (0.6 - 0.2) = 0.5; below and above are clamped.
TEST(Stretched, MapsTheRangeToZeroToOne) {
  ImageF image(3, 1);
  image(0, 0) = 0.1F;
  image(1, 0) = 0.4F;
  image(2, 0) = 0.9F;
  const ImageF result = stretched(image, 0.2F, 0.6F);
  EXPECT_EQ(result(0, 0), 0.0F);
  EXPECT_FLOAT_EQ(result(1, 0), 0.5F);
  EXPECT_EQ(result(2, 0), 1.0F);
  EXPECT_EQ(stretched(image, 0.6F, 0.6F), image);
}

/// A search for a detection rate whose designs have intervals of 2 x half_width.
Json noisy_report(double baseline, double winner, double half_width) {
  const std::string rate = "inspection.detection_rate";
  const auto scores = [&](double value) {
    return Json{
        {rate, value}, {rate + ".low", value - half_width}, {rate + ".high", value + half_width}};
  };
  return {{"status", "done"},
          {"objective", {{"name", rate}, {"sense", "maximise"}}},
          {"designs",
           Json::array({Json{{"key", "baseline"}, {"scores", scores(baseline)}},
                        Json{{"key", "winner"}, {"scores", scores(winner)}}})},
          {"trials", Json::array({Json{{"number", 1}}})}};
}

// Half widths of 3 points each: 3 sqrt(2) = 4.2 points for the difference.
TEST(ReportVerdict, SaysWhetherTheLeadIsLargerThanTheNoise) {
  const Json sure = noisy_report(0.5, 0.6, 0.03);
  EXPECT_THAT(sentence_of(sure),
              HasSubstr("The lead over the baseline is larger than the noise (4.2 points)"));
  EXPECT_EQ(complete_report(sure)["verdict"]["tone"], "good");
  const Json open = noisy_report(0.5, 0.54, 0.03);
  EXPECT_THAT(sentence_of(open), HasSubstr("is not larger than the noise (4.2 points)"));
  EXPECT_EQ(complete_report(open)["verdict"]["tone"], "neutral");
  EXPECT_THAT(sentence_of(noisy_report(0.5, 0.4, 0.03)),
              AllOf(HasSubstr("worse than the baseline"), Not(HasSubstr("lead"))));
  EXPECT_THAT(sentence_of(search_report()), Not(HasSubstr("noise")));
}

// Fresh seeds count, with their own interval: 10 points of lead shrink to 2.
TEST(ReportVerdict, ComparesFreshNumbersWithFreshIntervals) {
  Json data = noisy_report(0.5, 0.6, 0.03);
  const std::string rate = "inspection.detection_rate";
  for (Json& design : data["designs"]) {
    const double value = design["key"] == "winner" ? 0.52 : 0.50;
    design["rescored"] = {
        {rate, value}, {rate + ".low", value - 0.04}, {rate + ".high", value + 0.04}};
  }
  EXPECT_THAT(sentence_of(data), HasSubstr("is not larger than the noise (5.7 points)"));
}

// Scans without noise: what differs between them is rounding, and a tie is no lead.
TEST(ReportVerdict, SaysThatScansHaveNoNoise) {
  const auto scanned = [](double baseline, double winner) {
    Json data = noisy_report(baseline, winner, 0.0);
    data["designs"][0]["repeated"]["inspection.detection_rate"] = {baseline, baseline, baseline};
    data["designs"][1]["repeated"]["inspection.detection_rate"] = {winner, winner + 1e-16, winner};
    return sentence_of(data);
  };
  EXPECT_THAT(scanned(0.5, 0.6), HasSubstr("is larger than the noise (none)"));
  EXPECT_THAT(scanned(0.6, 0.6), AllOf(HasSubstr("level with"), Not(HasSubstr("noise"))));
}

TEST(RenderReport, LabelsScoresOfAnInspection) {
  const Json info = complete_report(noisy_report(0.5, 0.6, 0.03))["score_info"];
  EXPECT_EQ(info["inspection.detection_rate"]["label"], "detection rate");
  EXPECT_EQ(info["inspection.detection_rate"]["format"], "percent");
  EXPECT_EQ(info["inspection.detection_rate.low"]["label"], "detection rate, lower bound");
  EXPECT_EQ(info["inspection.detection_rate.low"]["format"], "percent");
}

}  // namespace
}  // namespace glint
