// SPDX-License-Identifier: GPL-3.0-or-later
//
// What noise leaves of the winner of a study: its race, its true value, and how both are told.
#include "studies/run/search_race.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/rng.h"
#include "optimizer/storage/storage.h"
#include "studies/run/run.h"
#include "studies/run/run_report.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

TEST(ToldValue, WeighsReplicatesAndTheModelByWhatTheyKnow) {
  // Mean 10, variance of one 4, so that four are as good as a weight of 1; the model's sd of 0 and
  // the noise of the search's own numbers make a weight of 1/4: (10 + 9 / 4) / (1 + 1 / 4) = 9.8.
  const std::vector<double> values = {
      10.0 - std::sqrt(3.0) * std::sqrt(2.0), 10.0, 10.0, 10.0 + std::sqrt(3.0) * std::sqrt(2.0)};
  const Expectation model = {.mean = 9.0, .sd = 0.0};
  const Estimate told = told_value(values, 0.0, &model);
  EXPECT_NEAR(told.value, 9.8, 1e-12);
  // Student with 3 degrees: 3.1824 / sqrt(1.25).
  EXPECT_NEAR(told.high - told.value, 2.8464, 1e-3);
  EXPECT_NEAR(told_value(values, 0.0, nullptr).value, 10.0, 1e-12);
}

TEST(ToldValue, IsNoSurerThanTheScoreItselfSays) {
  const std::vector<double> alike = {5.0, 5.0, 5.0, 5.0};
  EXPECT_EQ(told_value(alike, 0.0, nullptr).low, 5.0);
  // 3.1824 x 0.6 / sqrt(4)
  EXPECT_NEAR(told_value(alike, 0.6, nullptr).low, 5.0 - 0.9547, 1e-3);
}

/// The best of twenty designs by one noisy evaluation each: what was seen of it is too good, what
/// is told is right in 90 to 98 of 100 cases.
TEST(ToldValue, CoversTheTruthWhereWhatWasSeenIsTooGood) {
  int covered = 0;
  double seen_bias = 0.0;
  double told_bias = 0.0;
  constexpr int kCases = 400;
  for (int i = 0; i < kCases; ++i) {
    Rng rng(3, Stream::kTest, static_cast<std::uint64_t>(i));
    double truth = 0.0;
    double seen = -1e9;
    for (int k = 0; k < 20; ++k) {
      const double one = rng.normal();
      if (const double value = one + rng.normal(); value > seen) {
        truth = one;
        seen = value;
      }
    }
    // What Bayes makes of a prior and an evaluation of variance 1.
    const Expectation model = {.mean = 0.5 * seen, .sd = std::sqrt(0.5)};
    std::vector<double> values;
    for (int k = 0; k < 8; ++k) {
      values.push_back(truth + rng.normal());
    }
    const Estimate told = told_value(values, 0.0, &model);
    covered += told.low <= truth && truth <= told.high ? 1 : 0;
    seen_bias += (seen - truth) / kCases;
    told_bias += (told.value - truth) / kCases;
  }
  EXPECT_GE(covered, 360);
  EXPECT_LE(covered, 392);
  EXPECT_GT(seen_bias, 0.5);
  EXPECT_LT(std::abs(told_bias), 0.06);
}

const std::string kNoisyRing = "schema = 1\n" + kPathPlate + kPathRing + R"(
[prototypes.low]
title = "As low as can be"
"lighting.ring.height_mm" = 20
[variables]
"lighting.ring.height_mm" = { min = 20, max = 40 }
[objective]
maximise = "defects.min_weber"
[search]
noisy = true
[budget]
evaluations = 10
)";

Json run_noisy(const TemporaryFolder& folder,
               const std::string& name,
               const std::string& text = kNoisyRing,
               std::atomic<int>* interrupt = nullptr) {
  write_file(folder / "study.toml", text);
  return run_study(load_study(folder / "study.toml", {}),
                   {.out = folder / name,
                    .threads = 2,
                    .jobs = 1,
                    .progress = Progress::Style::kNone,
                    .interrupt = interrupt});
}

TEST(SearchRace, ChoosesTheWinnerOfANoisySearch) {
  const TemporaryFolder folder;
  const Json result = run_noisy(folder, "out");
  const Json& race = result.at("race");
  EXPECT_EQ(race.at("finalists"), 2);
  double sum = 0.0;
  std::set<std::string> keys;
  const Json* winner = nullptr;
  for (const Json& row : race.at("entrants")) {
    sum += row.at("probability").get<double>();
    keys.insert(row.at("key").get<std::string>());
    winner = row.at("key") == "winner" ? &row : winner;
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
  ASSERT_NE(winner, nullptr);
  EXPECT_TRUE(keys.contains("low"));
  EXPECT_EQ(winner->at("trial"), result.at("best").at("trial"));
  EXPECT_EQ(winner->at("replicates"), 8);
  EXPECT_GT(winner->at("expected_sd").get<double>(), 0.0);
  const Storage storage = Storage::read(folder / "out/study.sqlite");
  EXPECT_EQ(race.at("evaluations"), storage.trials(TrialKind::kReplicate).size());
  ASSERT_EQ(result.at("probability_best").size(), race.at("entrants").size());
  const Json& told = result.at("best").at("told");
  EXPECT_LT(told.at("low"), told.at("value"));
  EXPECT_LT(told.at("value"), told.at("high"));
  EXPECT_NE(told.at("value"), told.at("seen"));
}

TEST(SearchRace, IsToldByTheReport) {
  const TemporaryFolder folder;
  const Json result = run_noisy(folder, "out");
  const Json data = report_data({folder / "out"});
  const auto panel = std::ranges::find(
      data.at("panels"), Json("noise"), [](const Json& one) { return one.at("id"); });
  ASSERT_NE(panel, data.at("panels").end());
  EXPECT_THAT(panel->at("lead").get<std::string>(), HasSubstr("2 finalists raced"));
  EXPECT_THAT(panel->at("lead").get<std::string>(), HasSubstr("the search saw"));
  EXPECT_EQ(panel->at("tables")[0].at("rows").size(), result.at("race").at("entrants").size());
  EXPECT_EQ(data.at("probability_best"), result.at("probability_best"));
  const auto& findings = result.at("verdict").at("findings");
  EXPECT_TRUE(std::ranges::any_of(
      findings, [](const Json& one) { return one.at("code") == "probability_best"; }));
}

TEST(SearchRace, IsLeftOutWithoutNoiseOrWhereItIsNotWanted) {
  const TemporaryFolder folder;
  EXPECT_FALSE(run_noisy(folder, "none", kNoisyRing + "race = 0\n").contains("race"));
  std::string calm = kNoisyRing;
  calm.replace(calm.find("noisy = true"), 12, "noisy = false");
  EXPECT_FALSE(run_noisy(folder, "calm", calm).contains("race"));
  EXPECT_EQ(run_noisy(folder, "asked", calm + "race = 3\n").at("race").at("finalists"), 3);
}

TEST(SearchRace, OfSeveralObjectivesIsRefused) {
  const TemporaryFolder folder;
  std::string text = kNoisyRing + "race = 3\n";
  text.replace(text.find("[objective]"),
               11,
               "[[objective]]\nmaximise = \"homogeneity.h_rms\"\n[[objective]]");
  try {
    run_noisy(folder, "out", text);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("budget.race: is of one objective"));
  }
}

}  // namespace
}  // namespace glint
