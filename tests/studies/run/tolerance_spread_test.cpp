// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/tolerance/tolerance_spread.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/thread_pool.h"
#include "optimizer/storage/sqlite.h"
#include "studies/definition/manufacture.h"
#include "studies/definition/study_text.h"
#include "studies/run/check_study.h"
#include "studies/run/run.h"
#include "studies/tolerance/tolerance_panel.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

/// Whose folder holds the built designs, too.
StudyIdentity identity_of(const Study& study) {
  return {.config_hash = config_hash(study), .config_text = {}, .code_version = {}, .seed = 1};
}

Json variables_of(const Point& point) {
  return point;
}

const std::string kSearch = "schema = 1\n" + kPathPlate + kPathRing + R"(
[variables]
"lighting.ring.height_mm" = { min = 20, max = 60 }
"lighting.ring.radiance.0" = { min = 0.1, max = 0.2 }
[objective]
maximise = "homogeneity.mean"
[constraints]
"homogeneity.clipped_share" = { max = 0.5 }
"defects.min_cnr" = { min = -1 }
[search]
algorithm = "sobol"
[budget]
evaluations = 3
)";

Study study_of(const TemporaryFolder& folder, const std::string& tolerances) {
  write_file(folder / "study.toml", kSearch + tolerances);
  return load_study(folder / "study.toml", {});
}

std::string refusal(const std::string& tolerances) {
  const TemporaryFolder folder;
  try {
    study_of(folder, "[manufacture]\n" + tolerances);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

// The picture is proportional to the radiance: spread evenly by 0.03 about 0.15 its mean has a
// standard deviation of 0.03 / 0.15 / sqrt(3) = 0.1155 of itself.
TEST(ToleranceSpread, IsThatOfAUniformKey) {
  const TemporaryFolder folder;
  const Study study =
      study_of(folder, "[manufacture]\n\"lighting.ring.radiance.0\" = { plus_minus = 0.03 }\n");
  ThreadPool pool(2);
  SceneStore store(pool);
  BuiltDesigns built(store, study, identity_of(study), folder.path());
  const Json spread = *tolerance_spread(built, study, {}, {40.0, 0.15}, variables_of);
  EXPECT_EQ(spread["designs"], 64);
  EXPECT_TRUE(spread["robust"]["is_winner"]) << "nothing is known to propose another one from";
  EXPECT_EQ(spread["evaluations"], 65);
  EXPECT_EQ(spread["failed"], 0);
  EXPECT_EQ(spread["distribution"], "uniform");
  EXPECT_EQ(spread["plus_minus"]["lighting.ring.radiance.0"], 0.03);
  EXPECT_EQ(spread["feasible_share"], 1.0);
  const Json& mean = spread["scores"]["homogeneity.mean"];
  const auto nominal = mean["nominal"].get<double>();
  EXPECT_NEAR(mean["mean"].get<double>() / nominal, 1.0, 0.01);
  EXPECT_NEAR(mean["sd"].get<double>() / nominal, 0.2 / std::sqrt(3.0), 0.005);
  EXPECT_NEAR(mean["low"].get<double>() / nominal, 1.0 - 0.9 * 0.2, 0.02);
  EXPECT_NEAR(mean["high"].get<double>() / nominal, 1.0 + 0.9 * 0.2, 0.02);
  EXPECT_EQ(spread, *tolerance_spread(built, study, {}, {40.0, 0.15}, variables_of));
}

// 24 LEDs, two more or less: five numbers, each as likely.
TEST(ToleranceSpread, OfAnIntegerIsOfWholeNumbers) {
  const TemporaryFolder folder;
  std::string text = kSearch;
  const std::string radiance = "\"lighting.ring.radiance.0\" = { min = 0.1, max = 0.2 }\n";
  text.replace(
      text.find(radiance), radiance.size(), "\"lighting.ring.leds\" = { min = 16, max = 32 }\n");
  text.replace(text.find("homogeneity.mean"), 16, "lighting.leds");
  text.replace(text.find("height_mm = 30"), 14, "height_mm = 30\nleds = 24\nled_diameter_mm = 2");
  write_file(folder / "study.toml",
             text + "[manufacture]\n\"lighting.ring.leds\" = { plus_minus = 2 }\n");
  const Study study = load_study(folder / "study.toml", {});
  ThreadPool pool(2);
  SceneStore store(pool);
  BuiltDesigns built(store, study, identity_of(study), folder.path());
  std::map<double, int> counts;
  for (const Point& offset : built.variable_offsets()) {
    ++counts[offset.at(1)];
  }
  ASSERT_EQ(counts.size(), 5U);
  for (const auto& [offset, count] : counts) {
    EXPECT_EQ(offset, std::round(offset));
    EXPECT_LE(std::abs(offset), 2.0);
    EXPECT_NEAR(count, 64.0 / 5.0, 2.0);
  }
  const BuiltScores scores = built.build({{40.0, 24.0}}, 0, 3).at(0);
  for (std::size_t k = 0; k < scores.size(); ++k) {
    ASSERT_TRUE(scores[k].has_value());
    EXPECT_EQ(scores[k]->at("lighting.leds"), 24.0 + built.variable_offsets()[k].at(1));
  }
}

// Of the 64 three differ: each is evaluated once, by one thread.
TEST(ToleranceSpread, EqualBuiltDesignsAreEvaluatedOnce) {
  const TemporaryFolder folder;
  std::string text = kSearch;
  text.replace(text.find("height_mm = 30"), 14, "height_mm = 30\nleds = 24\nled_diameter_mm = 2");
  write_file(folder / "study.toml",
             text + "[manufacture]\n\"lighting.ring.leds\" = { plus_minus = 1 }\n");
  const Study study = load_study(folder / "study.toml", {});
  ThreadPool pool(1);
  SceneStore store(pool);
  BuiltDesigns built(store, study, identity_of(study), folder.path(), {}, 2);
  EXPECT_EQ(built.build({{40.0, 0.15}}, 0, kToleranceDesigns).at(0).size(), 64U);
  EXPECT_EQ(Storage::read(folder / kBuiltTrials).trials(TrialKind::kSearch).size(), 3U);
  Database record(folder / kBuiltTrials, Database::Access::kReadOnly);
  EXPECT_EQ(record.integer("SELECT count(*) FROM evaluation"), 3);
}

// Programs before took it: a run that they began is not refused for it.
TEST(ToleranceSpread, AnEmptyTableBeginsNoRun) {
  const TemporaryFolder folder;
  const Study study = study_of(folder, "[manufacture]\n");
  EXPECT_THROW(check_study(study, {.threads = 1}), ConfigError);
  const auto refused = [&] {
    try {
      run_study(study,
                {.out = folder / "run",
                 .threads = 1,
                 .jobs = 1,
                 .progress = Progress::Style::kNone,
                 .log_file = {}});
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused(), HasSubstr("manufacture: is empty, must name"));
  std::filesystem::create_directories(folder / "run");
  Storage::open(folder / "run/study.sqlite", {.config_hash = "of another study"});
  EXPECT_THAT(refused(), HasSubstr("another study"));
}

// An inner radius of 15 +- 12 mm is no ring from the outer radius of 25 mm on: one of 12.
TEST(ToleranceSpread, WhatCannotBeMadeMissesTheLimits) {
  const TemporaryFolder folder;
  const Study study =
      study_of(folder, "[manufacture]\n\"lighting.ring.inner_radius_mm\" = { plus_minus = 12 }\n");
  ThreadPool pool(2);
  SceneStore store(pool);
  BuiltDesigns built(store, study, identity_of(study), folder.path());
  const Json spread = *tolerance_spread(built, study, {}, {40.0, 0.15}, variables_of);
  const int failed = spread["failed"].get<int>();
  EXPECT_NEAR(failed, 64.0 / 12.0, 1.0);
  EXPECT_DOUBLE_EQ(spread["feasible_share"].get<double>(), (64.0 - failed) / 64.0);
  EXPECT_DOUBLE_EQ(spread["robust"]["feasible_share"].get<double>(), (64.0 - failed) / 64.0);
  const std::string lead = tolerance_panel(spread, Json::object())["lead"];
  EXPECT_THAT(lead, HasSubstr("92 % of them meet every limit"));
  EXPECT_THAT(lead, HasSubstr(" 5 could not be made or evaluated, and count as outside"));
}

TEST(ToleranceSpread, StandsInResultAndReport) {
  const TemporaryFolder folder;
  const RunOptions options = {.out = folder / "run",
                              .threads = 2,
                              .jobs = 1,
                              .progress = Progress::Style::kNone,
                              .log_file = {}};
  // A key that is no variable, too.
  const Json result = run_study(
      study_of(folder, "[manufacture]\n\"lighting.ring.inner_radius_mm\" = { plus_minus = 2 }\n"),
      options);
  EXPECT_EQ(result["evaluations"], 3) << "counted apart";
  EXPECT_GT(result["manufacture"]["scores"]["homogeneity.mean"]["sd"].get<double>(), 0.0);
  EXPECT_THAT(read_file(folder / "run/report.html"), HasSubstr("As it will be built"));
  const Json panel = tolerance_panel(result["manufacture"], result["best"]["variables"]);
  const auto& rows = panel["tables"][0]["rows"];
  EXPECT_TRUE(std::ranges::none_of(rows, [](const Json& row) {
    return row[0].get<std::string>().starts_with("homogeneity.");
  })) << rows;
  EXPECT_THAT(read_file(folder / "run/study.resolved.toml"), HasSubstr("plus_minus"));
}

/// So much light as a limit of clipped pixels allows.
const std::string kClipped = "schema = 1\n" + kPathPlate + kPathRing + R"(
[variables]
"lighting.ring.radiance.0" = { min = 0.1, max = 8 }
[objective]
maximise = "homogeneity.mean"
[constraints]
"homogeneity.clipped_share" = { max = 0.01 }
"defects.min_cnr" = { min = -1 }
[search]
algorithm = "sobol"
[budget]
evaluations = 16
[manufacture]
"lighting.ring.radiance.0" = { plus_minus = 0.8 }
)";

Study clipped_study(const TemporaryFolder& folder) {
  write_file(folder / "study.toml", kClipped);
  return load_study(folder / "study.toml", {});
}

Json run_clipped(const std::filesystem::path& out,
                 const Study& study,
                 int jobs,
                 const std::atomic<int>* interrupt = nullptr) {
  return run_study(study,
                   {.out = out,
                    .threads = 2,
                    .jobs = jobs,
                    .progress = Progress::Style::kNone,
                    .log_file = {},
                    .interrupt = interrupt});
}

// The brightest design within the limit leaves it when it is built brighter: the robust one is at
// least nearly the tolerance darker, and its built ones keep the limit.
TEST(ToleranceSpread, TheRobustOptimumKeepsTheLimitAsBuilt) {
  const TemporaryFolder folder;
  const Study study = clipped_study(folder);
  const Json result = run_clipped(folder / "run", study, 1);
  const Json& manufacture = result["manufacture"];
  const Json& robust = manufacture["robust"];
  const char* radiance = "lighting.ring.radiance.0";
  EXPECT_LT(manufacture["feasible_share"].get<double>(), 0.95);
  EXPECT_TRUE(robust["winner"]["value"].is_null()) << "19 of 20 do not keep the limit";
  EXPECT_FALSE(robust["is_winner"].get<bool>());
  EXPECT_GE(robust["feasible_share"].get<double>(), 0.95);
  EXPECT_LT(robust["variables"][radiance].get<double>(),
            result["best"]["variables"][radiance].get<double>());
  EXPECT_GT(robust["probability"].get<double>(), 0.9);
  EXPECT_TRUE(robust["reached"]["value"].is_number());
  EXPECT_EQ(result["evaluations"], 16) << "counted apart";
  EXPECT_LE(manufacture["evaluations"].get<int>(), kMaxBuiltDesigns);
  const std::string page = read_file(folder / "run/report.html");
  EXPECT_THAT(page, HasSubstr("The robust optimum"));
  // The same with two at once, and read again from the record.
  EXPECT_EQ(run_clipped(folder / "two", study, 2)["manufacture"], manufacture);
  const Storage record = Storage::read(folder / "run" / kBuiltTrials);
  EXPECT_EQ(record.trials(TrialKind::kSearch).size(),
            manufacture["evaluations"].get<std::size_t>());
  EXPECT_EQ(record.events().size(), manufacture["evaluations"].get<std::size_t>());
}

// What a killed run has built is not built again; what it lacks follows, to the same numbers.
TEST(ToleranceSpread, GoesOnWithTheDesignsThatAreBuilt) {
  const TemporaryFolder folder;
  const Study study = clipped_study(folder);
  ThreadPool pool(2);
  SceneStore store(pool);
  const auto spread_in = [&](const std::string& name, const std::atomic<int>* interrupt) {
    std::filesystem::create_directories(folder / name);
    BuiltDesigns built(store, study, identity_of(study), folder / name, {}, 1, interrupt);
    return tolerance_spread(built, study, {}, {1.0}, variables_of);
  };
  const Json whole = *spread_in("whole", nullptr);
  std::filesystem::create_directories(folder / "cut");
  {  // a record that ends within the second part, one design asked and not built
    const Storage source = Storage::read(folder / "whole" / kBuiltTrials);
    Storage cut = Storage::open(folder / "cut" / kBuiltTrials, identity_of(study));
    for (Trial& trial : source.trials(TrialKind::kSearch)) {
      if (trial.number <= 21) {
        const std::optional<Outcome> outcome = trial.outcome;
        trial.outcome.reset();
        cut.append(std::vector<Event>{{.kind = EventKind::kAsk, .trial = trial.number}},
                   std::vector<Trial>{trial});
        if (trial.number <= 20) {
          cut.record(TrialKind::kSearch, trial.number, *outcome);
        }
      }
    }
  }
  const std::atomic<int> interrupted = 1;
  EXPECT_FALSE(spread_in("cut", &interrupted).has_value());
  EXPECT_EQ(*spread_in("cut", nullptr), whole);
  EXPECT_EQ(*spread_in("cut", &interrupted), whole) << "nothing is left to build";
  const auto seconds_of = [&](const char* name) {
    std::vector<double> seconds;
    for (const Trial& trial :
         Storage::read(folder / name / kBuiltTrials).trials(TrialKind::kSearch)) {
      seconds.push_back(trial.outcome->seconds);
    }
    return seconds;
  };
  const std::vector<double> first = seconds_of("whole");
  const std::vector<double> second = seconds_of("cut");
  ASSERT_EQ(second.size(), first.size());
  EXPECT_TRUE(std::equal(first.begin(), first.begin() + 20, second.begin())) << "as recorded";
}

TEST(ToleranceSpread, IsCountedByCheck) {
  const TemporaryFolder folder;
  const Json told = check_study(clipped_study(folder), {.threads = 2});
  EXPECT_EQ(told["manufacture_evaluations"], kMaxBuiltDesigns);
  const Json& cpu_s = told["predicted_cpu_s"];
  EXPECT_NEAR(cpu_s["manufacture"].get<double>(),
              kMaxBuiltDesigns * told["seconds_per_evaluation"].get<double>(),
              1e-9);
  EXPECT_GE(cpu_s["total"].get<double>(),
            cpu_s["search"].get<double>() + cpu_s["manufacture"].get<double>());
  EXPECT_FALSE(
      check_study(study_of(folder, ""), {.threads = 2}).contains("manufacture_evaluations"));
}

TEST(ToleranceSpread, IsNotInStudiesWithoutIt) {
  const TemporaryFolder folder;
  const Study plain = study_of(folder, "");
  EXPECT_EQ(resolved_text(plain).find("manufacture"), std::string::npos);
  const Study built =
      study_of(folder, "[manufacture]\n\"lighting.ring.radiance.0\" = { plus_minus = 0.01 }\n");
  EXPECT_NE(config_hash(plain), config_hash(built));
  std::vector<Problem> errors;
  EXPECT_TRUE(read_tolerances(plain, errors).empty());
  EXPECT_TRUE(errors.empty());
}

TEST(ToleranceSpread, RefusesWhatHasNoMeaning) {
  const std::string radiance = "\"lighting.ring.radiance.0\" = ";
  EXPECT_THAT(refusal(radiance + "{ plus_minus = 0 }\n"), HasSubstr("must be > 0"));
  EXPECT_THAT(refusal(radiance + "{ plus_minus = -1 }\n"), HasSubstr("must be > 0"));
  EXPECT_THAT(refusal(radiance + "{ plus_minus = 0.06 }\n"), HasSubstr("beyond the variable's"));
  EXPECT_THAT(refusal(radiance + "0.01\n"), HasSubstr("must be a table"));
  EXPECT_THAT(refusal(radiance + "{ plus = 0.01 }\n"), HasSubstr("must be a table"));
  EXPECT_THAT(refusal("\"material.roughness\" = { plus_minus = 0.8 }\n"),
              HasSubstr("beyond the key's range"));
  EXPECT_THAT(refusal("\"material.type\" = { plus_minus = 1 }\n"), HasSubstr("is a number"));
  EXPECT_THAT(refusal("\"lighting.ring.leds\" = { plus_minus = 1.5 }\n"),
              HasSubstr("a whole number"));
  EXPECT_THAT(refusal("\"lighting.ring.heigth_mm\" = { plus_minus = 1 }\n"),
              HasSubstr("nearest one is \"lighting.ring.height_mm\""));
  EXPECT_EQ(refusal(radiance + "{ plus_minus = 0.05 }\n"), "");
}

}  // namespace
}  // namespace glint
