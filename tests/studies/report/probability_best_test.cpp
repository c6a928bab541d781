// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

const std::string kScore = "defects.min_cnr";

/// Designs of equal scores, without repeated scans.
Json study(const std::vector<std::string>& keys) {
  Json data = {{"objective", {{"name", kScore}, {"sense", "maximise"}}},
               {"designs", Json::array()}};
  for (const std::string& key : keys) {
    const Json scores = {{kScore, 5.0}};
    data["designs"].push_back(
        {{"key", key}, {"title", key}, {"scores", scores}, {"rescored", scores}});
  }
  return data;
}

/// Squared deviations of how often the first design was truly the best from what was said, in bins
/// of what was said, over their variances: chi-square with as many degrees of freedom as bins.
double calibration(const std::vector<std::pair<double, bool>>& cases) {
  constexpr std::array<double, 5> kEdges = {0.0, 0.6, 0.8, 0.95, 1.01};
  double sum = 0.0;
  for (std::size_t bin = 0; bin + 1 < kEdges.size(); ++bin) {
    double excess = 0.0;
    double variance = 1e-3;
    for (const auto& [probability, is_best] : cases) {
      if (probability >= kEdges[bin] && probability < kEdges[bin + 1]) {
        excess += (is_best ? 1.0 : 0.0) - probability;
        variance += probability * (1.0 - probability);
      }
    }
    sum += excess * excess / variance;
  }
  return sum;
}

// Four designs, true values one apart (standard deviation), eight scans with a noise of 1 that all
// have in common and one of 1 of their own.
TEST(ProbabilityBest, IsCalibrated) {
  constexpr double kOnePercent = 13.28;  // of chi-square with 4 degrees of freedom
  std::vector<std::pair<double, bool>> cases;
  std::vector<std::pair<double, bool>> too_sure;
  for (std::uint64_t number = 0; number < 400; ++number) {
    Rng rng(17, Stream::kTest, number);
    Json data = study({"baseline", "ring", "dome", "bar"});
    std::array<double, 4> truth = {};
    std::array<double, 8> common = {};
    std::ranges::generate(truth, [&] { return 5.0 + rng.normal(); });
    std::ranges::generate(common, [&] { return rng.normal(); });
    for (std::size_t i = 0; i < truth.size(); ++i) {
      std::vector<double> scans;
      for (const double shared : common) {
        scans.push_back(truth[i] + shared + rng.normal());
      }
      data["designs"][i]["repeated"] = {{kScore, scans}};
    }
    const Json first = complete_report(data)["probability_best"][0];
    const auto best = static_cast<std::size_t>(std::ranges::max_element(truth) - truth.begin());
    const bool is_best = first["key"] == data["designs"][best]["key"];
    const double probability = first["probability"].get<double>();
    cases.emplace_back(probability, is_best);
    too_sure.emplace_back(std::pow(probability, 0.25), is_best);
  }
  EXPECT_LT(calibration(cases), kOnePercent);
  EXPECT_GT(calibration(too_sure), kOnePercent) << "the negative control";
}

/// A search with a winner beside its baseline.
Json search() {
  Json data = study({"baseline", "winner"});
  data["status"] = "done";
  data["trials"] = {{{"number", 1},
                     {"failed", false},
                     {"feasible", true},
                     {"objective", 5.0},
                     {"scores", {{kScore, 5.0}}}}};
  return data;
}

TEST(ProbabilityBest, IsSaidOfASearchsWinner) {
  Json data = search();
  const auto said = [](const Json& report) {
    return std::ranges::count(report["verdict"]["findings"],
                              "probability_best",
                              [](const Json& one) { return one["code"].get<std::string>(); });
  };
  EXPECT_FALSE(complete_report(data).contains("probability_best")) << "no repeated scans";
  EXPECT_EQ(said(complete_report(data)), 0);
  for (Json& design : data["designs"]) {
    const double value = design["key"] == "winner" ? 20.0 : 5.0;
    design["repeated"] = {{kScore, {value, value + 0.1, value - 0.1, value}}};
  }
  const Json complete = complete_report(data);
  EXPECT_EQ(complete["probability_best"][0]["key"], "winner");
  EXPECT_NEAR(complete["probability_best"][0]["probability"].get<double>(), 1.0, 0.001);
  EXPECT_THAT(complete["verdict"]["details"].back().get<std::string>(),
              HasSubstr("winner over 99 %"));
  EXPECT_EQ(said(complete), 1);
  EXPECT_EQ(complete_report(complete), complete);
}

}  // namespace
}  // namespace glint
