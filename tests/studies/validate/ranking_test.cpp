// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/ranking.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/thread_pool.h"
#include "optimizer/storage/storage.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"
#include "studies/validate/rescored_designs.h"
#include "studies/validate/validate_result.h"
#include "tests/studies/validate/trial_cell.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

RankedDesign design(const std::string& name, double simulated, double real) {
  RankedDesign made = {.name = name};
  for (int view = 0; view < 3; ++view) {
    const std::string key = "view_" + std::to_string(view);
    made.simulated[key] = simulated + 0.1 * view;
    made.real[key] = real + 0.1 * view + 0.01 * ((view * 7) % 3);
  }
  return made;
}

TEST(Ranking, AgreesWhereBothSidesHaveOneOrder) {
  const Ranking ranking = rank_designs({design("a", 3, 2.8), design("b", 5, 4.6)}, true);
  EXPECT_TRUE(ranking.agrees);
  EXPECT_EQ(ranking.simulated, (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(ranking.real, ranking.simulated);
  ASSERT_EQ(ranking.pairs.size(), 1U);
  EXPECT_FALSE(ranking.pairs[0].is_level);
  // First against second: 3 - 5 = -2.
  EXPECT_NEAR(ranking.pairs[0].simulated.value, -2.0, 1e-12);
}

TEST(Ranking, DoesNotAgreeWhereTheOrderIsReversed) {
  const Ranking ranking = rank_designs({design("a", 3, 6), design("b", 5, 4.6)}, true);
  EXPECT_FALSE(ranking.agrees);
  EXPECT_TRUE(ranking.pairs[0].is_against);
}

TEST(Ranking, OfDesignsThatAreLevelCannotBeTold) {
  RankedDesign a = design("a", 3, 3);
  RankedDesign b = design("b", 3.01, 2.99);
  a.real["view_0"] += 0.5;
  b.real["view_1"] += 0.5;
  const Ranking ranking = rank_designs({a, b}, true);
  EXPECT_TRUE(ranking.agrees);
  EXPECT_TRUE(ranking.pairs[0].is_level);
}

TEST(Ranking, MinimisesWhereAsked) {
  const Ranking ranking = rank_designs({design("a", 3, 2.8), design("b", 5, 4.6)}, false);
  EXPECT_EQ(ranking.real.front(), "a");
}

// a and b share view 1 alone: 3 - 5 = -2, where their means are 6.5 and 3.
TEST(Ranking, IsThatOfTheViewsThatBothHave) {
  const RankedDesign a = {
      .name = "a", .simulated = {{"0", 10}, {"1", 3}}, .real = {{"0", 10}, {"1", 3}}};
  const RankedDesign b = {
      .name = "b", .simulated = {{"1", 5}, {"2", 1}}, .real = {{"1", 5}, {"2", 1}}};
  const Ranking ranking = rank_designs({a, b}, true);
  EXPECT_NEAR(ranking.pairs[0].simulated.value, -2.0, 1e-12);
  EXPECT_FALSE(ranking.pairs[0].is_level);
  EXPECT_EQ(ranking.simulated, (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(ranking.real, ranking.simulated);
}

TEST(Ranking, OfDesignsWithoutACommonViewCannotBeTold) {
  const RankedDesign a = {.name = "a", .simulated = {{"0", 10}}, .real = {{"0", 10}}};
  const RankedDesign b = {.name = "b", .simulated = {{"1", 5}}, .real = {{"1", 25}}};
  const Ranking ranking = rank_designs({a, b}, true);
  EXPECT_TRUE(ranking.pairs[0].is_level);
  EXPECT_TRUE(ranking.agrees);
}

// Beside an objective that has no real side, too.
TEST(RankingsText, SaysThatAnOrderIsNotProvenWhereACauseIsLeft) {
  const Ranking same = rank_designs({design("a", 3, 2.8), design("b", 5, 4.6)}, true);
  const Ranking other = rank_designs({design("a", 3, 6), design("b", 5, 4.6)}, true);
  const ObjectiveRanking none = {.objective = "area", .reason = "no real side"};
  const auto with_cause = [](const std::vector<ObjectiveRanking>& rankings) {
    return rankings_text(rankings, false);
  };
  const auto not_proven = testing::HasSubstr("not proven");
  EXPECT_THAT(with_cause({{.objective = "cnr", .ranking = same}, none}), not_proven);
  EXPECT_THAT(with_cause({{.objective = "cnr", .ranking = other}, none}), Not(not_proven));
  EXPECT_EQ(with_cause({none}), "");
  EXPECT_THAT(rankings_text({{.objective = "cnr", .ranking = same}}, true), Not(not_proven));
}

TEST(RankingSheet, TellsWhyThereIsNoOrder) {
  Study study;
  study.has_objective = true;
  study.goal.objective = {.name = "seen"};
  study.goal.more_objectives = {{.name = "size", .is_maximised = false}};
  RankingSheet sheet(study);
  for (const auto& [name, seen] : {std::pair("a", 3.0), std::pair("b", 5.0)}) {
    sheet.add(name, "0", {.simulated = {{"seen", seen}, {"size", 1.0}}, .real = {{"seen", seen}}});
  }
  const auto rankings = sheet.rankings(2);
  ASSERT_EQ(rankings.size(), 2U);
  ASSERT_TRUE(rankings[0].ranking);
  EXPECT_EQ(rankings[0].ranking->real.front(), "b");
  EXPECT_FALSE(rankings[1].ranking);
  EXPECT_THAT(rankings[1].reason, testing::HasSubstr("none of 2 designs"));
  EXPECT_THAT(sheet.rankings(1)[0].reason, testing::HasSubstr("one design alone"));
  EXPECT_THAT(RankingSheet(std::nullopt).rankings(2)[0].reason,
              testing::HasSubstr("no study.resolved.toml"));
}

// One view of path tracing: 3 +- 1.96 x 0.1; the camera's picture has no such error.
TEST(BothScores, OfOneViewHaveTheIntervalOfTheirRendering) {
  const BothScores one = {.simulated = {{"seen", 3.0}, {"seen.error", 0.1}},
                          .real = {{"seen", 2.9}}};
  const auto told = both_scores_json({one});
  EXPECT_NEAR(told["seen"]["simulated"]["low"].get<double>(), 2.804, 1e-9);
  EXPECT_EQ(told["seen"]["simulated"]["interval"], "rendering");
  EXPECT_TRUE(told["seen"]["real"]["low"].is_null());
  EXPECT_EQ(told["seen"]["real"]["interval"], "one view: none");
  EXPECT_EQ(both_scores_json({one, one})["seen"]["real"]["interval"], "views");
}

/// A run's folder with ring and dome, of which no pictures are taken, traced coarsely.
Study coarse_run(const std::filesystem::path& folder, const std::string& study_tables) {
  make_trial(folder, {}, {}, 0, study_tables);
  const std::filesystem::path study = folder / "run/study.resolved.toml";
  for (const std::filesystem::path& file :
       {study, folder / "run/ring/scene.toml", folder / "run/dome/scene.toml"}) {
    std::string text = read_file(file);
    const std::string samples = "samples = 16";
    EXPECT_NE(text.find(samples), std::string::npos) << file;
    write_file(file, text.replace(text.find(samples), samples.size(), "samples = 2"));
  }
  return load_study(study, {});
}

nlohmann::ordered_json rescored(const std::filesystem::path& folder,
                                const Study& study,
                                const DesignRefit& refit = {}) {
  ThreadPool pool(1);
  SceneStore store(pool);
  return rescore_designs(store, study, folder / "run", {"ring", "dome"}, refit);
}

// The lights of the best design are nearly dead on the robot, those of the other one are not.
TEST(RescoreDesigns, TellWhomTheRefitLiftsAboveTheWinner) {
  const TemporaryFolder folder;
  std::string tables(kTrialStudy);
  const std::string cnr = "\"defects.min_cnr\"";
  ASSERT_NE(tables.find(cnr), std::string::npos);
  tables.replace(tables.find(cnr), cnr.size(), "\"homogeneity.mean\"");  // hardly noisy
  const Study study = coarse_run(folder.path(), tables);
  const auto same = rescored(folder.path(), study);
  EXPECT_EQ(same["changed"], false);
  EXPECT_EQ(same["order_before"], same["order_after"]);
  ASSERT_EQ(same["order_before"].size(), 2U);
  const std::string winner = same["winner_before"].get<std::string>();
  EXPECT_EQ(winner, same["order_before"][0]);
  EXPECT_THAT(same["text"].get<std::string>(), testing::HasSubstr(winner + " stays the winner"));
  const auto dead = rescored(folder.path(), study, {.exposures = {{winner, 1e-3}}});
  EXPECT_EQ(dead["winner_before"], winner);
  EXPECT_EQ(dead["changed"], true) << dead;
  EXPECT_EQ(dead["order_after"][0], dead["winner_after"]);
  EXPECT_THAT(dead["text"].get<std::string>(), testing::HasSubstr("takes the place of " + winner));
}

// What a cell exposes as designed is as dark as the refit says, though sensor.expose_to is set.
TEST(RescoreDesigns, OfEqualExposureAreExposedBeforeTheRefit) {
  const TemporaryFolder folder;
  Study study = coarse_run(folder.path(), kTrialStudy);
  study.goal.objective.name = "homogeneity.mean";
  const std::filesystem::path scene = folder / "run/ring/scene.toml";
  SceneSettings ring = load_study(scene, {}).scene;
  ring.expose_to = 0.5;
  write_file(scene, "schema = 2\n" + to_toml(write_scene(ring)));
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto result =
      rescore_designs(store, study, folder / "run", {"ring"}, {.exposures = {{"ring", 0.5}}});
  const double before = result["designs"][0]["before"].get<double>();
  EXPECT_GT(before, 0.1);
  EXPECT_NEAR(result["designs"][0]["after"].get<double>(), 0.5 * before, 0.02 * before) << result;
}

// The refit all but switches off the brighter design.
TEST(RescoreDesigns, TellTheOrderByEachOfSeveralObjectives) {
  const TemporaryFolder folder;
  Study study = coarse_run(folder.path(), kTrialStudy);
  study.goal.more_objectives = {{.name = "homogeneity.mean"}};
  const auto same = rescored(folder.path(), study);
  ASSERT_EQ(same["objectives"].size(), 2U) << same;
  EXPECT_EQ(same["objectives"][0]["objective"], "defects.min_cnr");
  const auto& by_mean = same["objectives"][1];
  EXPECT_EQ(by_mean["objective"], "homogeneity.mean");
  EXPECT_EQ(by_mean["changed"], false);
  EXPECT_EQ(by_mean["order_before"], by_mean["order_after"]);
  const std::string bright = by_mean["order_before"][0].get<std::string>();
  const auto dead = rescored(folder.path(), study, {.exposures = {{bright, 1e-3}}});
  EXPECT_EQ(dead["objectives"][1]["changed"], true) << dead;
  EXPECT_EQ(dead["objectives"][1]["order_before"][0], bright);
  ASSERT_EQ(dead["objectives"][1]["order_after"].size(), 2U);
  EXPECT_EQ(dead["objectives"][1]["order_after"][1], bright);
  EXPECT_THAT(dead["text"].get<std::string>(),
              testing::HasSubstr("by homogeneity.mean is another"));
}

// Two designs that are nearly the same: the refit darkens the better one by a little, which the
// noise of two samples a pixel hides.
TEST(RescoreDesigns, CannotTellByLessThanTheNoiseOfRendering) {
  const TemporaryFolder folder;
  const Study study = coarse_run(folder.path(), kTrialStudy);
  SceneSettings twin = load_study(folder / "run/ring/scene.toml", {}).scene;
  twin.sensor.exposure *= 0.9999;
  make_folder(folder / "run/twin");
  write_file(folder / "run/twin/scene.toml", "schema = 2\n" + to_toml(write_scene(twin)));
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto with = [&](const DesignRefit& refit) {
    return rescore_designs(store, study, folder / "run", {"ring", "twin"}, refit);
  };
  const std::string winner = with({})["winner_before"].get<std::string>();
  const auto near = with({.exposures = {{winner, 0.97}}});
  ASSERT_NE(near["order_after"][0], winner) << near;
  EXPECT_TRUE(near["changed"].is_null()) << near;
  EXPECT_EQ(near["untold"], near["order_after"][0]);
  EXPECT_EQ(near["winner_after"], winner);
  EXPECT_THAT(near["text"].get<std::string>(), testing::HasSubstr("cannot be told"));
}

// Views that are made of the scene go with the part like listed ones.
TEST(RefittedScene, MovesTheViewpointsOfASphereAlongWithThePart) {
  const TemporaryFolder folder;
  std::string text = kTrialScene;
  text.erase(text.find("[[viewpoint]]"));
  write_file(folder / "scene.toml", text + "[viewpoints]\nsource = \"sphere\"\ncount = 2\n");
  const SceneSettings scene = load_study(folder / "scene.toml", {}).scene;
  ThreadPool pool(1);
  SceneStore store(pool);
  const Part& part = store.build(scene)->part;
  const auto before = viewpoints_of(scene, part);
  const DesignRefit moved = {.scene_from_part = {.translation_mm = {1.0, 0.0, 0.0}}};
  const auto after = viewpoints_of(refitted_scene(store, scene, moved, "ring"), part);
  ASSERT_EQ(after.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(after[i].position_mm[0], before[i].position_mm[0] - 1.0, 1e-9);
    EXPECT_NEAR(after[i].position_mm[2], before[i].position_mm[2], 1e-9);
  }
  EXPECT_EQ(refitted_scene(store, scene, {}, "ring").viewpoint_set.source,
            ViewpointSource::kSphere);
}

// 22 trials with a score and one that failed: the best 20 of them, the best one first.
TEST(RescoreDesigns, AreAlsoTheBestTrialsOfTheSearch) {
  const TemporaryFolder folder;
  const Study study = coarse_run(folder.path(),
                                 std::string(kTrialStudy) +
                                     "[variables]\n\"lighting.ring.radiance.0\" = "
                                     "{ min = 0.1, max = 4 }\n");
  {
    Storage storage = Storage::open(folder / "run/study.sqlite", {.config_hash = "of the test"});
    for (int number = 1; number <= 23; ++number) {
      const Trial trial = {.number = number, .point = {0.1 * number}};
      storage.append(std::vector<Event>{{.kind = EventKind::kAsk, .trial = number}},
                     std::vector<Trial>{trial});
      storage.record(TrialKind::kSearch,
                     number,
                     {.scores = {{"defects.min_cnr", 0.01 * number}}, .is_failed = number == 23});
    }
  }
  const auto result = rescored(folder.path(), study);
  ASSERT_EQ(result["designs"].size(), 22U) << result;
  EXPECT_EQ(result["designs"][1]["of"], "run");
  EXPECT_EQ(result["designs"][2]["of"], "search");
  EXPECT_EQ(result["designs"][2]["name"], "trial 22");
  EXPECT_EQ(result["designs"][21]["name"], "trial 3");
  EXPECT_EQ(result["order_after"].size(), 22U);
}

}  // namespace
}  // namespace glint
