// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a run of many parts says of itself, from its result.json.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/population/population_report.h"
#include "studies/population/population_verdict.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Json estimate(double value, double low, double high) {
  return {{"value", value}, {"low", low}, {"high", high}};
}

Json sorted_parts() {
  const Json baseline = {
      {"right", 9},
      {"tested", 10},
      {"share_right", estimate(0.9, 0.6, 0.98)},
      {"false_alarms", {{"per_part", estimate(0.02, 0.0, 0.05)}, {"blobs", 2}, {"scans", 100}}}};
  return {{"sorting", {{"designs", {{"baseline", baseline}}}}}};
}

/// A curve through a90, or none.
Json lighting(const std::string& title, const Json& a90) {
  Json design = {{"title", title}, {"fit", nullptr}, {"levels", Json::array({{{"size", 2.0}}})}};
  if (!a90.is_null()) {
    design["fit"] = {{"a90", {{"value", a90}, {"low", 0.1}, {"high", 1.5}}}, {"a90_95", 1.5}};
  }
  return design;
}

Json detected_sizes(const Json& a90_of_panels, const Json& a90_of_dome) {
  return {{"pod",
           {{"unit", "um"},
            {"designs",
             {{"baseline", lighting("Two panels", a90_of_panels)},
              {"dome", lighting("The dome", a90_of_dome)}}}}}};
}

/// Of the designs, as report_verdict() gives it.
Json verdict_of_job(const std::string& tone) {
  return {{"sentence", "Dome has the best h."},
          {"tone", tone},
          {"details", Json::array()},
          {"findings", {{{"code", "ranked"}, {"text", "Dome has the best h."}}}}};
}

/// Beside a good verdict on the designs.
Json verdict_on(const Json& result) {
  return with_population_verdict(verdict_of_job("good"), result);
}

std::vector<std::string> codes_of(const Json& verdict) {
  std::vector<std::string> codes;
  for (const Json& finding : verdict["findings"]) {
    codes.push_back(finding["code"]);
  }
  return codes;
}

TEST(PopulationVerdict, SaysHowManyPartsAreSortedAsTheExpertDoes) {
  const Json verdict = verdict_on(sorted_parts());
  EXPECT_EQ(verdict["findings"][0]["code"], "sorted");
  EXPECT_EQ(verdict["sentence"],
            "9 of 10 tested parts are in the expert's class, 90.0 % (60.0 to 98.0 %); a flawless "
            "part has at most 0.0500 false alarms (2 on 100 scans).");
  EXPECT_THAT(
      codes_of(verdict_on(detected_sizes(1.3, 0.1))),
      ::testing::ElementsAre("detectable_size", "detectable_size", "detectable_size", "ranked"));
}

TEST(PopulationVerdict, SaysFromWhichSizeOnDefectsAreFound) {
  const Json verdict = verdict_on(detected_sizes(1.3, 0.1));
  EXPECT_EQ(verdict["sentence"],
            "The dome finds nine of ten defects from 0.100 um on, 13 times smaller than under Two "
            "panels.");
  EXPECT_EQ(verdict["details"][0], "Two panels: a90 1.30 (0.100 to 1.50) um, a90/95 1.50 um");
}

TEST(PopulationVerdict, SaysWhereNoCurveCanBeFitted) {
  const Json verdict = verdict_on(detected_sizes(nullptr, nullptr));
  EXPECT_EQ(verdict["sentence"],
            "No lighting gives a curve from which the size of a defect that is found follows.");
  EXPECT_EQ(verdict["details"][1], "The dome: no curve can be fitted");
}

TEST(PopulationVerdict, GoesBeforeThatOfTheDesigns) {
  const Json verdict = verdict_on(sorted_parts());
  EXPECT_THAT(codes_of(verdict), ::testing::ElementsAre("sorted", "ranked"));
  EXPECT_EQ(verdict["details"], Json::array({"Dome has the best h."}));
  EXPECT_EQ(verdict["tone"], "neutral");
  EXPECT_EQ(with_population_verdict(verdict_of_job("bad"), sorted_parts())["tone"], "bad");
}

TEST(PopulationVerdict, SaysBothOfPartsThatAreSortedAndDetected) {
  Json both = sorted_parts();
  both["pod"] = detected_sizes(1.3, 0.1)["pod"];
  const Json verdict = verdict_on(both);
  EXPECT_EQ(codes_of(verdict)[0], "sorted");
  EXPECT_EQ(codes_of(verdict)[1], "detectable_size");
  EXPECT_THAT(verdict["sentence"].get<std::string>(),
              ::testing::AllOf(HasSubstr("in the expert's class"), HasSubstr("nine of ten")));
}

// The largest size that was tried is 2 um.
TEST(PopulationVerdict, TellsNoSizeBeyondTheLargestThatWasTried) {
  EXPECT_EQ(verdict_on(detected_sizes(5.0, 0.1))["sentence"],
            "The dome finds nine of ten defects from 0.100 um on; under Two panels no size up to "
            "2.00 um is found as often.");
  EXPECT_EQ(verdict_on(detected_sizes(5.0, 7.0))["sentence"],
            "No lighting finds nine of ten defects of any size up to 2.00 um.");
}

TEST(PopulationVerdict, IsNoneWithoutAPopulation) {
  EXPECT_EQ(verdict_on(Json::object()), verdict_of_job("good"));
  EXPECT_THAT(population_summary(Json::object()), IsEmpty());
}

}  // namespace
}  // namespace glint
