// SPDX-License-Identifier: GPL-3.0-or-later
//
// The finalists of a search among kinds of light: a rough plate under a ring, a bar, or both.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/storage/storage.h"
#include "studies/accuracy/outcome_labels.h"
#include "studies/definition/render_methods.h"
#include "studies/evaluation/evaluation.h"
#include "studies/run/run.h"
#include "studies/run/run_texts.h"
#include "studies/run/study_search.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

const std::string kKinds =
    "schema = 1\nlighting_use = \"ring\"\n" + kPathPlate + kPathRing + kPathBar + R"(
[variables]
"lighting_use" = { choices = ["ring", "left", "ring+left"] }
"lighting.ring.height_mm" = { min = 20, max = 40, when = "lighting_use in [ring, ring+left]" }
[objective]
maximise = "defects.min_weber"
[constraints]
"homogeneity.mean" = { max = 0.9 }
[search]
algorithm = "sobol"
[budget]
evaluations = 9
)";

Study study_in(const TemporaryFolder& folder, const std::string& text) {
  write_file(folder / "study.toml", text);
  return load_study(folder / "study.toml", {});
}

TEST(BestOfEachKind, AreTheBestTrialsRescoredInTheSameWay) {
  const TemporaryFolder folder;
  const Study study = study_in(folder, kKinds);
  const Json result = run_study(
      study, {.out = folder / "out", .threads = 2, .jobs = 2, .progress = Progress::Style::kNone});
  const Json& kinds = result.at("kinds");
  ASSERT_EQ(kinds.size(), 3U);
  ThreadPool pool(2);
  SceneStore store(pool);
  std::map<int, Replicate> kept;
  for (Replicate& one : Storage::read(folder / "out/study.sqlite").replicates(TrialKind::kSearch)) {
    if (one.rung == kRescoredRung) {
      kept[one.number] = std::move(one);
    }
  }
  std::set<std::string> names;
  for (const Json& kind : kinds) {
    EXPECT_EQ(kept.at(kind.at("trial").get<int>()).outcome.scores.at("defects.min_weber"),
              kind.at("rescored").at("defects.min_weber").get<double>());
    names.insert(kind.at("lighting_use").get<std::string>());
    EXPECT_EQ(kind.at("variables").at("lighting_use"), kind.at("lighting_use"));
    EXPECT_LE(kind.at("scores").at("homogeneity.mean").get<double>(), 0.9);
    EXPECT_TRUE(kind.at("feasible").is_boolean());
    // Scored by hand: finer, with other random numbers.
    Overrides overrides;
    for (const auto& [key, value] : kind.at("variables").items()) {
      overrides.emplace_back(key,
                             value.is_string() ? ConfigNode::from_text(value.get<std::string>())
                                               : ConfigNode::from_number(value.get<double>()));
    }
    const SceneSettings finer = rescoring_settings(scene_with(study, overrides));
    const Scores fresh =
        evaluate(store, finer, {}, wanted_by(study.goal).with_whole_scan(kFreshParts)).scores;
    EXPECT_EQ(kind.at("rescored").at("defects.min_weber").get<double>(),
              fresh.at("defects.min_weber"));
    EXPECT_NE(kind["rescored"]["defects.min_weber"], kind["scores"]["defects.min_weber"]);
  }
  EXPECT_EQ(names.size(), 3U);
  EXPECT_THAT(read_file(folder / "out/report.html"), HasSubstr("\"title\":\"Kinds of light\""));
  for (std::size_t i = 1; i < kinds.size(); ++i) {
    if (kinds[i - 1]["feasible"] == kinds[i]["feasible"] && kinds[i]["feasible"].get<bool>()) {
      EXPECT_GE(kinds[i - 1]["rescored"]["defects.min_weber"].get<double>(),
                kinds[i]["rescored"]["defects.min_weber"].get<double>());
    }
  }
}

/// The model expects more of a trial that was seen to be worse; the winner stands for its kind.
TEST(BestOfEachKind, AreThoseThatAreExpectedToBeTheBest) {
  const TemporaryFolder folder;
  const Study study = study_in(folder, kKinds);
  ThreadPool pool(2);
  SceneStore store(pool);
  const auto seen = [](int number, double kind, double height_mm, double weber) {
    return Trial{
        .number = number,
        .point = {kind, height_mm},
        .outcome = Outcome{.scores = {{"defects.min_weber", weber}, {"homogeneity.mean", 0.5}}}};
  };
  const std::vector<Trial> trials = {
      seen(1, 0.0, 25.0, 0.9), seen(2, 0.0, 35.0, 0.5), seen(3, 2.0, 30.0, 0.8)};
  const auto trial_of_ring = [&](const Expectations& expected, int winner) {
    const Json kinds = best_of_each_kind(store, study, trials, {}, expected, winner);
    const auto ring = std::ranges::find_if(
        kinds, [](const Json& kind) { return kind.at("lighting_use") == "ring"; });
    return ring == kinds.end() ? 0 : ring->at("trial").get<int>();
  };
  EXPECT_EQ(trial_of_ring({}, 0), 1);
  EXPECT_EQ(trial_of_ring({{1, {{0.4, 0.1}}}, {2, {{0.6, 0.1}}}}, 0), 2);
  EXPECT_EQ(trial_of_ring({{1, {{0.4, 0.1}}}, {2, {{0.6, 0.1}}}}, 1), 1);
}

/// A race of one finalist: those of the other kinds come in addition.
TEST(BestOfEachKind, AreInTheRaceOfTheFinalists) {
  const TemporaryFolder folder;
  const Study study = study_in(folder, kKinds + "race = 1\n");
  const Json result = run_study(
      study, {.out = folder / "out", .threads = 2, .jobs = 2, .progress = Progress::Style::kNone});
  std::set<std::string> raced;
  for (const Json& entrant : result.at("race").at("entrants")) {
    if (entrant.contains("trial")) {
      raced.insert(entrant.at("variables").at("lighting_use").get<std::string>());
    }
  }
  EXPECT_EQ(raced, (std::set<std::string>{"ring", "left", "ring+left"}));
  EXPECT_EQ(result.at("race").at("finalists"), 3);
}

/// Of several objectives: the compromise of each kind's own front, in the order of the choice.
TEST(BestOfEachKind, OfSeveralObjectivesAreTheCompromisesOfTheirFronts) {
  const TemporaryFolder folder;
  std::string text = kKinds;
  text.replace(text.find("[objective]"),
               11,
               "[[objective]]\nmaximise = \"homogeneity.h_rms\"\n[[objective]]");
  text.replace(text.find("evaluations = 9"), 15, "evaluations = 15");
  const Study study = study_in(folder, text);
  const Json result = run_study(
      study, {.out = folder / "out", .threads = 2, .jobs = 2, .progress = Progress::Style::kNone});
  const Json& kinds = result.at("kinds");
  ASSERT_EQ(kinds.size(), 3U);
  std::vector<Trial> trials = Storage::read(folder / "out/study.sqlite").trials(TrialKind::kSearch);
  std::size_t on_front = 0;
  for (const Json& kind : kinds) {
    on_front += kind.at("on_front").get<std::size_t>();
    EXPECT_GE(kind.at("hypervolume").get<double>(), 0.0);
    EXPECT_LE(kind.at("hypervolume").get<double>(), result.at("hypervolume").get<double>());
    EXPECT_NE(kind.at("rescored").at("defects.min_weber"),
              kind.at("scores").at("defects.min_weber"));
    // No trial of the kind beats it in both.
    const Scores own = trials[kind.at("trial").get<std::size_t>() - 1].outcome->scores;
    for (const Trial& trial : trials) {
      const bool is_of_kind =
          trial.point[0] == trials[kind.at("trial").get<std::size_t>() - 1].point[0];
      EXPECT_FALSE(is_of_kind && is_better(study.goal, trial.outcome->scores, own));
    }
  }
  EXPECT_EQ(on_front, result.at("front").size());
}

/// Areas of 1257, 200 and 1457 mm2, heights of 0, 4.5 and some 12 mm: all heights are within the
/// aspiration, the ring's by most, and of what reaches it the knee is taken, the bar.
TEST(BestOfEachKind, ByAspirationsAreInTheOrderInWhichTheyAreTaken) {
  const TemporaryFolder folder;
  std::string text = kKinds;
  const std::size_t begin = text.find("[objective]");
  text.replace(begin, text.find("[search]") - begin, R"([[objective]]
minimise = "lighting.area_mm2"
[[objective]]
minimise = "lighting.height_mm"
aspiration = 20
[choice]
by = "aspirations"
)");
  const Study study = study_in(folder, text);
  ThreadPool pool(1);
  SceneStore store(pool);
  std::vector<Trial> trials;
  for (const double kind : {0.0, 1.0, 2.0}) {
    trials.push_back({.number = static_cast<int>(kind) + 1,
                      .point = {kind, 30.0},
                      .outcome = Outcome{.scores = {{"lighting.area_mm2", 1.0 + kind},
                                                    {"lighting.height_mm", 3.0 - kind}}}});
  }
  std::vector<std::string> order;
  for (const Json& kind : best_of_each_kind(store, study, trials)) {
    EXPECT_TRUE(kind["feasible"].get<bool>());
    EXPECT_LT(kind["rescored"]["lighting.height_mm"].get<double>(), 20.0);
    order.push_back(kind["lighting_use"].get<std::string>());
  }
  EXPECT_EQ(order, (std::vector<std::string>{"left", "ring", "ring+left"}));
}

/// A bar has no height of the ring: what stands in the point is the middle of the range.
TEST(TrialsCsv, HasNoValuesOfInactiveVariables) {
  const TemporaryFolder folder;
  const Study study = study_in(folder, kKinds);
  Storage storage = Storage::open(folder / "s.sqlite", {.config_hash = "abc"});
  storage.append(
      std::vector<Event>{{.kind = EventKind::kAsk, .trial = 1},
                         {.kind = EventKind::kAsk, .trial = 2}},
      std::vector<Trial>{{.number = 1, .point = {0.0, 25.0}}, {.number = 2, .point = {1.0, 30.0}}});
  EXPECT_EQ(trials_csv(study, storage),
            "trial,state,feasible,lighting_use,lighting.ring.height_mm,message\n"
            "1,asked,,ring,25,\n"
            "2,asked,,left,,\n");
}

TEST(BestOfEachKind, OfASearchWithoutKindsIsNothing) {
  const TemporaryFolder folder;
  std::string text = kKinds;
  text.erase(text.find("\"lighting_use\" = {"),
             text.find("\"lighting.ring.height_mm\"") - text.find("\"lighting_use\" = {"));
  const std::string when = ", when = \"lighting_use in [ring, ring+left]\"";
  text.erase(text.find(when), when.size());
  const Study study = study_in(folder, text);
  ThreadPool pool(1);
  SceneStore store(pool);
  EXPECT_TRUE(best_of_each_kind(store, study, {}).is_null());
  const Study kinds = study_in(folder, kKinds);
  EXPECT_EQ(best_of_each_kind(store, kinds, {}), Json::array()) << "nothing was evaluated";
}

}  // namespace
}  // namespace glint
