// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_choice.h"

#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "studies/frontier/design_ranking.h"
#include "studies/frontier/frontier_methods.h"
#include "tests/studies/frontier/steel_under_ring.h"
#include "tests/studies/plate_under_two_lights.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

constexpr const char* kHomogeneity = "homogeneity.h_rms";

/// A rung of the ladder and a point of the frontier for each of 4, 16, 64 samples.
std::vector<RenderRung> three_rungs() {
  std::vector<RenderRung> ladder(3);
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    ladder[i].paths.samples = 4 << (2 * i);
    ladder[i].work = ladder[i].paths.samples;
    ladder[i].is_noisy = true;
  }
  return ladder;
}

Frontier three_points() {
  Frontier frontier;
  frontier.reference.method.is_noisy = true;
  frontier.reference.scores[kHomogeneity].value = 0.5;
  for (const RenderRung& rung : three_rungs()) {
    const int samples = rung.paths.samples;
    FrontierPoint point;
    point.method.paths = rung.paths;
    point.method.is_noisy = true;
    point.label = fmt::format("{} samples", samples);
    point.tessellation = "exact surface";
    point.h_error_points = 4.0 / samples;  // 1, 0.25, 0.0625
    point.scores[kHomogeneity].error = 0.04 / samples;
    point.defects["dent"] = {.weber_percent = 100.0 / samples, .change_percent = 0.0};
    frontier.points.push_back(point);
  }
  return frontier;
}

std::string label_of_choice(const Frontier& frontier) {
  const auto found = std::ranges::find_if(frontier.points, &FrontierPoint::is_chosen);
  return found != frontier.points.end() ? found->label : "none";
}

std::string chosen_by(Frontier frontier,
                      const std::optional<AccuracySettings>& accuracy = {},
                      const std::vector<RenderRung>& ladder = three_rungs()) {
  mark_choice(ladder, accuracy, frontier);
  return label_of_choice(frontier);
}

// 16 samples: 0.25 points of h, 6.25 % of contrast; 64: 0.0625 and 1.6 %.
TEST(FrontierChoice, WithoutDesignsIsWithinTheBoundsOfStability) {
  Frontier frontier = three_points();
  EXPECT_EQ(chosen_by(frontier), "64 samples");
  frontier.points[1].defects["dent"].weber_percent = 4.9;
  EXPECT_EQ(chosen_by(frontier), "16 samples");
  frontier.points[1].reduction = 4;
  EXPECT_EQ(chosen_by(frontier), "64 samples") << "no ladder has a quarter of the resolution";
  frontier.points[2].problem = "left out";
  EXPECT_EQ(chosen_by(frontier), "none");
  mark_choice(three_rungs(), {}, frontier);
  EXPECT_THAT(choice_sentence(frontier), HasSubstr("there is no automatic choice"));
}

DesignRanking ranking_of_points() {
  return {.score = kHomogeneity,
          .reference = "64 samples",
          .designs = 12,
          .methods = {{.label = "4 samples", .is_right = false},
                      {.label = "16 samples", .agreement = {.pairs = 66}, .is_right = true}}};
}

TEST(FrontierChoice, WithDesignsOrdersThemRightly) {
  Frontier frontier = three_points();
  frontier.ranking = ranking_of_points();
  EXPECT_EQ(chosen_by(frontier), "16 samples") << "whatever its own errors are";
  EXPECT_EQ(chosen_by(frontier, AccuracySettings{.is_auto = true}), "16 samples");
  mark_choice(three_rungs(), {}, frontier);
  EXPECT_THAT(choice_sentence(frontier), HasSubstr("puts 12 designs into the order"));
  EXPECT_THAT(choice_sentence(frontier), HasSubstr("by 66 pairs"));
  frontier.points[1].is_chosen = false;
  frontier.reference.method.is_noisy = false;
  EXPECT_EQ(chosen_by(frontier), "none") << "mirrors have no such mark";
}

// Errors of 0.01, 0.0025, 0.000625 of a score of 0.5. The order of designs has no say then.
TEST(FrontierChoice, WithTolerancesKeepsAllOfThem) {
  Frontier frontier = three_points();
  frontier.ranking = ranking_of_points();
  AccuracySettings accuracy = {.wishes = {{.score = kHomogeneity, .tolerance = 0.001}}};
  EXPECT_EQ(chosen_by(frontier, accuracy), "64 samples");
  accuracy.wishes[0].tolerance = 0.02;
  EXPECT_EQ(chosen_by(frontier, accuracy), "4 samples");
  accuracy.wishes[0].is_relative = true;
  accuracy.wishes[0].tolerance = 0.01;  // 0.005
  EXPECT_EQ(chosen_by(frontier, accuracy), "16 samples");
  mark_choice(three_rungs(), accuracy, frontier);
  EXPECT_THAT(choice_sentence(frontier), HasSubstr("that is within 1 % of homogeneity.h_rms."));
  frontier.points[1].is_chosen = false;
  accuracy.wishes.push_back({.score = "defects.min_cnr", .tolerance = 100.0});
  EXPECT_EQ(chosen_by(frontier, accuracy), "none") << "it was not measured";
}

TEST(FrontierChoice, IsTheRungOfTheLeastCountedWork) {
  const AccuracySettings any = {.wishes = {{.score = kHomogeneity, .tolerance = 1.0}}};
  Frontier frontier = three_points();
  frontier.points[0].cpu_s = 3.0;
  frontier.points[1].cpu_s = 2.0;
  frontier.points[2].cpu_s = 1.0;
  EXPECT_EQ(chosen_by(frontier, any), "4 samples") << "no clock has a say";
  std::vector<RenderRung> ladder = three_rungs();
  ladder[1].work = 1.0;
  EXPECT_EQ(chosen_by(frontier, any, ladder), "16 samples");
}

TEST(FrontierChoice, IsARungThatASearchMayTake) {
  const AccuracySettings any = {.wishes = {{.score = kHomogeneity, .tolerance = 1.0}}};
  std::vector<RenderRung> ladder = three_rungs();
  ladder[0].paths.samples = 8;
  EXPECT_EQ(chosen_by(three_points(), any, ladder), "16 samples");
  ladder[1].paths.max_reflections += 1;
  EXPECT_EQ(chosen_by(three_points(), any, ladder), "64 samples");
  ladder[2].is_for_search = false;
  EXPECT_EQ(chosen_by(three_points(), any, ladder), "none");
}

Study steel_study(const std::vector<KeyValue>& sets) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             std::string(test::kSteelUnderRing) +
                 "[variables]\n\"lighting.ring.height_mm\" = { min = 40, max = 160 }\n"
                 "[objective]\nmaximise = \"homogeneity.h_rms\"\n");
  return load_study(folder / "study.toml", sets);
}

/// All points of the study's chart, none of which is off by anything.
std::string chosen_of_exact_points(const Study& study) {
  Frontier frontier;
  frontier.reference.method.is_noisy = true;
  frontier.points = frontier_methods(study.scene);
  mark_choice(study, frontier);
  return label_of_choice(frontier);
}

// 1 and 4 samples are no rungs, and the first of 16 and more is beyond what the file sets.
TEST(FrontierChoice, IsOfTheStudysOwnLadder) {
  EXPECT_EQ(chosen_of_exact_points(steel_study({})), "direct sum, 1 ray");
  EXPECT_EQ(chosen_of_exact_points(steel_study({{"render.method", "paths"}})),
            "8 samples, 1 reflection");
  EXPECT_EQ(chosen_of_exact_points(
                steel_study({{"render.method", "paths"}, {"render.paths.max_reflections", "1"}})),
            "8 samples");
  EXPECT_EQ(chosen_of_exact_points(steel_study({{"variables", "{}"}})), "direct sum, 1 ray")
      << "a scene has a ladder, too";
}

/// A mirror under a tunnel, or under a ring, which paths follow.
Study two_lights_study(const std::vector<KeyValue>& sets) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             std::string(test::kPlateUnderTwoLights) +
                 "[variables]\nlighting_use = { choices = [\"tunnel\", \"ring\"] }\n"
                 "\"sensor.gain\" = { min = 0.5, max = 2 }\n"
                 "[objective]\nmaximise = \"homogeneity.h_rms\"\n");
  return load_study(folder / "study.toml", sets);
}

/// All of its points exact.
Frontier marked_frontier(const Study& study) {
  Frontier frontier;
  frontier.reference.method.is_noisy = true;
  frontier.points = frontier_methods(study.scene);
  find_branch(study, frontier);
  mark_choice(study, frontier);
  return frontier;
}

TEST(FrontierChoice, IsOfTheScenesBranch) {
  const Study study = two_lights_study({{"lighting_use", "ring"}});
  Frontier frontier = marked_frontier(study);
  EXPECT_EQ(frontier.branch, 1U);
  EXPECT_NE(label_of_choice(frontier), "none");
  EXPECT_THAT(choice_sentence(frontier),
              HasSubstr("that of designs with lighting_use = ring: a run chooses one for each of 2 "
                        "branches (by lighting_use)"));
  frontier.ranking = ranking_of_points();
  mark_choice(study, frontier);
  EXPECT_THAT(frontier.choice_rule, HasSubstr("puts 12 designs with lighting_use = ring into"));
}

// The file lets both shine, which no design of the search does.
TEST(FrontierChoice, IsNoneWhereTheSceneLiesInNoBranch) {
  const Frontier frontier = marked_frontier(two_lights_study({}));
  EXPECT_TRUE(frontier.split.has_value());
  EXPECT_FALSE(frontier.branch.has_value());
  EXPECT_EQ(label_of_choice(frontier), "none");
  EXPECT_THAT(choice_sentence(frontier), HasSubstr("the scene lies in none of them"));
}

TEST(FrontierChoice, HasNoBranchWithoutSuchAChoice) {
  Frontier frontier;
  find_branch(steel_study({}), frontier);
  EXPECT_FALSE(frontier.split.has_value());
  EXPECT_FALSE(frontier.branch.has_value());
}

TEST(ChoiceGoal, HasTheScoresOfTheTolerances) {
  const Study study =
      steel_study({{"accuracy.tolerance", R"({ "homogeneity.clipped_share" = 0.01 })"}});
  const Goal goal = choice_goal(study);
  ASSERT_EQ(goal.constraints.size(), study.goal.constraints.size() + 1);
  EXPECT_EQ(goal.constraints.back().name, "homogeneity.clipped_share");
  EXPECT_EQ(goal.objective.name, kHomogeneity);
}

Goal two_objectives() {
  Goal goal;
  goal.objective = {.name = kHomogeneity};
  goal.more_objectives = {{.name = "homogeneity.mean"}};
  return goal;
}

// Four designs: 0, 1, 2, 3 by the reference; 1, 0, 2, 3 has one of six pairs turned: tau 2/3.
TEST(WorstOrder, IsThatOfTheObjectiveThatIsOrderedWorst) {
  const std::vector<double> right = {0.0, 1.0, 2.0, 3.0};
  const std::vector<double> nearly = {1.0, 0.0, 2.0, 3.0};
  const std::vector<std::vector<double>> reference = {right, right};
  const std::vector<std::vector<double>> errors(2, std::vector<double>(4, 0.01));
  const auto order = [&](const std::vector<double>& first, const std::vector<double>& second) {
    return worst_order(two_objectives(), {first, second}, reference, errors);
  };
  EXPECT_TRUE(order(right, right).is_right);
  EXPECT_FALSE(order(right, nearly).is_right);
  EXPECT_EQ(order(right, nearly).score, "homogeneity.mean");
  EXPECT_NEAR(order(right, nearly).agreement.tau, 2.0 / 3.0, 1e-12);
  EXPECT_FALSE(order(nearly, right).is_right);
  EXPECT_EQ(order(nearly, right).score, kHomogeneity);
}

// 2 and 4 above the reference, 3 on average.
TEST(TakeOutMeanErrors, LeavesWhatDiffersBetweenDesigns) {
  std::vector<Scores> cheap = {{{kHomogeneity, 3.0}}, {{kHomogeneity, 9.0}}};
  const std::vector<Scores> reference = {{{kHomogeneity, 1.0}}, {{kHomogeneity, 5.0}}};
  take_out_mean_errors(cheap, reference);
  EXPECT_DOUBLE_EQ(cheap[0].at(kHomogeneity), 0.0);
  EXPECT_DOUBLE_EQ(cheap[1].at(kHomogeneity), 6.0);
}

}  // namespace
}  // namespace glint
