// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/score_model.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/analysis/analysis_json.h"
#include "studies/analysis/branches.h"

namespace glint {
namespace {

using Kind = Variable::Kind;
using ::testing::HasSubstr;

SearchSpace box(int dimension) {
  SearchSpace space;
  for (int i = 0; i < dimension; ++i) {
    space.variables.push_back({.name = "x" + std::to_string(i), .low = 10.0, .high = 20.0});
  }
  return space;
}

/// A ring with a radius of its own and a dome with an opening, both at a height.
SearchSpace lights() {
  return {{{.name = "use", .kind = Kind::kChoice, .choices = {"ring", "dome"}},
           {.name = "radius", .when_name = "use", .when_value = "ring"},
           {.name = "opening", .when_name = "use", .when_value = "dome"},
           {.name = "height"}}};
}

const Goal kGoal = {.objective = {.name = "y", .is_maximised = true}, .constraints = {}};

using Function = std::function<double(const Point& point, int number)>;

std::vector<Trial> evaluated(const SearchSpace& space, int count, const Function& function) {
  const Sobol sequence(5, static_cast<int>(space.variables.size()));
  std::vector<Trial> trials;
  for (int k = 0; k < count; ++k) {
    const Point point = point_from_unit(space, sequence.point(static_cast<std::uint32_t>(k)));
    trials.push_back({.number = k + 1,
                      .point = point,
                      .outcome = Outcome{.scores = {{"y", function(point, k)}}}});
  }
  return trials;
}

double noise(int number) {
  return Rng(3, Stream::kTest, static_cast<std::uint64_t>(number)).normal();
}

// y = 3 x0 + x1 over [10, 20]: shares 9/10 and 1/10, x2 is dead. At x0 = 10 the average over x1 is
// 30 + 15 = 45.
TEST(AnalyseScore, TellsSharesAndResponsesOfAPlane) {
  const SearchSpace space = box(3);
  const auto trials = evaluated(space, 60, [](const Point& point, int k) {
    return 3.0 * point[0] + point[1] + 0.1 * noise(k);
  });
  const ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
  ASSERT_EQ(analysis.branches.size(), 1U);
  const BranchAnalysis& all = analysis.branches[0];
  ASSERT_TRUE(all.evidence.is_enough()) << all.evidence.reason();
  EXPECT_GT(analysis.q2, 0.98);
  EXPECT_EQ(analysis.wanted, 0);
  EXPECT_NEAR(all.importance[0].index.first.value, 0.9, 0.03);
  EXPECT_NEAR(all.importance[1].index.total.value, 0.1, 0.03);
  EXPECT_LT(all.importance[2].index.total.value, 0.01);
  const Response& response = all.responses[0];
  EXPECT_EQ(response.at.front(), 10.0);
  EXPECT_NEAR(response.average.front().mean, 45.0, 0.5);
  EXPECT_LE(response.average.front().low, 45.0);
  EXPECT_GE(response.average.front().high, 45.0);
  ASSERT_TRUE(all.map);
  EXPECT_EQ(all.map->x, 0U);
  EXPECT_EQ(all.map->y, 1U);
  EXPECT_NEAR(all.map->values.back().mean, 80.0, 0.5) << "both at 20";
}

TEST(AnalyseScore, FindsNoEvidenceInNoise) {
  const SearchSpace space = box(3);
  for (int seed = 0; seed < 5; ++seed) {
    const auto trials =
        evaluated(space, 60, [&](const Point&, int k) { return noise(1000 * seed + k); });
    const ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
    const BranchAnalysis& all = analysis.branches[0];
    EXPECT_FALSE(all.evidence.is_enough());
    EXPECT_TRUE(all.evidence.is_covered);
    EXPECT_TRUE(all.importance.empty());
    EXPECT_TRUE(all.responses.empty());
    EXPECT_EQ(analysis.wanted, 60);
  }
}

/// As in a space of few designs, where those of --evaluate come again: a score without noise that
/// nothing explains is told twice, and each telling predicts the other.
TEST(AnalyseScore, FindsNoEvidenceInDesignsThatWereEvaluatedTwice) {
  const SearchSpace space = box(2);
  const auto once = evaluated(space, 40, [](const Point&, int k) { return noise(k); });
  auto twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  const ScoreAnalysis analysis = analyse_score(space, kGoal, twice, "y");
  EXPECT_EQ(analysis.points, 40);
  EXPECT_EQ(analysis.without, 0);
  EXPECT_FALSE(analysis.branches[0].evidence.is_enough());
  EXPECT_EQ(analysis.q2, analyse_score(space, kGoal, once, "y").q2);
}

TEST(AnalyseScore, TakesTheMeanOfADesignThatWasEvaluatedAgain) {
  const SearchSpace space = box(2);
  auto trials = evaluated(space, 30, [](const Point& point, int) { return point[0]; });
  auto again = trials;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    trials[k].outcome->scores["y"] += 3.0;
    again[k].outcome->scores["y"] -= 3.0;
  }
  trials.insert(trials.end(), again.begin(), again.end());
  const ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
  EXPECT_GT(analysis.q2, 0.98);
  EXPECT_LT(analysis.noise, 0.5);
}

// The function is smooth and the model is right about it, but only in one corner.
TEST(AnalyseScore, FindsNoEvidenceInACorner) {
  const SearchSpace space = box(3);
  auto trials = evaluated(space, 60, [](const Point&, int) { return 0.0; });
  for (Trial& trial : trials) {
    for (double& value : trial.point) {
      value = 10.0 + 0.2 * (value - 10.0);
    }
    trial.outcome->scores["y"] = trial.point[0] + trial.point[1];
  }
  const ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
  EXPECT_GT(analysis.q2, 0.9);
  EXPECT_FALSE(analysis.branches[0].evidence.is_covered);
  EXPECT_TRUE(analysis.branches[0].importance.empty());
  EXPECT_GE(analysis.wanted, 5);
  EXPECT_THAT(analysis.branches[0].evidence.reason(), HasSubstr("empty"));
}

// y = 2 [dome] + radius or 0.5 opening: between branches 2^2 / 4 + ... see below.
TEST(AnalyseScore, TakesBranchesApart) {
  const SearchSpace space = lights();
  const auto trials = evaluated(space, 80, [](const Point& point, int k) {
    return (point[0] > 0.5 ? 2.0 + 0.5 * point[2] : point[1]) + 0.01 * noise(k);
  });
  const ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
  ASSERT_EQ(analysis.branches.size(), 2U);
  EXPECT_EQ(analysis.branches[0].name, "use = ring");
  ASSERT_TRUE(analysis.branches[0].evidence.is_enough()) << analysis.branches[0].evidence.reason();
  ASSERT_TRUE(analysis.branches[1].evidence.is_enough()) << analysis.branches[1].evidence.reason();
  EXPECT_EQ(analysis.branches[0].importance[0].variable, 1U);
  EXPECT_EQ(analysis.branches[1].importance[0].variable, 2U);
  for (const BranchAnalysis& branch : analysis.branches) {
    EXPECT_NEAR(branch.importance[0].index.total.value, 1.0, 0.03);
    EXPECT_LT(branch.importance[1].index.total.value, 0.03) << "height is dead";
  }
  // Means 0.5 and 2.25: variance between them 0.875^2 = 0.7656; within (1/12 + 1/48) / 2 = 0.0521.
  ASSERT_EQ(analysis.choices.size(), 1U);
  EXPECT_NEAR(analysis.choices[0].index.first.value, 0.7656 / 0.8177, 0.03);
}

TEST(AnalyseScore, LeavesOutFailuresAndIsNotConfusedByNothing) {
  const SearchSpace space = box(2);
  auto trials = evaluated(space, 6, [](const Point& point, int) { return point[0]; });
  trials[1].outcome->is_failed = true;
  trials[2].outcome->scores.clear();
  ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
  EXPECT_EQ(analysis.points, 4);
  EXPECT_EQ(analysis.without, 2);
  analysis = analyse_score(space, kGoal, trials, "unknown");
  EXPECT_EQ(analysis.points, 0);
  EXPECT_FALSE(analysis.branches[0].evidence.is_enough());
  EXPECT_GT(analysis.wanted, 0);
  EXPECT_EQ(analysis_json(space, analysis)["branches"][0]["is_enough"], false);
}

TEST(AnalyseScore, SaysThatAConstantHasNothingToExplain) {
  const SearchSpace space = box(2);
  const auto trials = evaluated(space, 20, [](const Point&, int) { return 0.25; });
  const ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
  EXPECT_FALSE(analysis.branches[0].evidence.is_enough());
  EXPECT_THAT(analysis.branches[0].evidence.reason(), HasSubstr("same value"));
  EXPECT_EQ(analysis.wanted, 0);
}

TEST(Branches, HoldTheVariablesThatAreActiveInThem) {
  const auto branches = branches_of(lights());
  ASSERT_EQ(branches.size(), 2U);
  EXPECT_EQ(branches[0].free, (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(branches[1].free, (std::vector<std::size_t>{2, 3}));
  const Point point = branches[1].point_at(lights(), std::vector<double>{0.25, 0.75});
  EXPECT_EQ(point, (Point{1, 0.5, 0.25, 0.75}));
  EXPECT_EQ(branches[1].unit_of(lights(), point), (std::vector<double>{0.25, 0.75}));
  EXPECT_EQ(branches_of(box(2))[0].name, "");
}

/// A score of 1 to 10 pictures; with 4 of them a phase counts.
SearchSpace pictures() {
  return {{{.name = "count", .kind = Kind::kInteger, .low = 1, .high = 10},
           {.name = "phase", .when_name = "count", .when_value = "4"},
           {.name = "height"}}};
}

TEST(Branches, ValuesWithTheSameActiveVariablesAreOne) {
  const SearchSpace space = pictures();
  const auto branches = branches_of(space);
  ASSERT_EQ(branches.size(), 2U);
  EXPECT_EQ(branches[0].name, "count other than 4");
  EXPECT_EQ(branches[0].free, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(branches[0].num_values_of(space, 0), 9.0);
  EXPECT_EQ(branches[1].name, "count = 4");
  EXPECT_EQ(branches[1].free, (std::vector<std::size_t>{1, 2}));
  std::vector<double> counts;
  for (int k = 0; k < 9; ++k) {
    const std::vector<double> unit = {(k + 0.5) / 9.0, 0.25};
    const Point point = branches[0].point_at(space, unit);
    counts.push_back(point[0]);
    EXPECT_EQ(branches[0].unit_of(space, point), unit);
  }
  EXPECT_EQ(counts, (std::vector<double>{1, 2, 3, 5, 6, 7, 8, 9, 10}));
  EXPECT_EQ(branch_names(space, std::vector<Point>{{4, 0.2, 0.5}, {7, 0.5, 0.5}}),
            (std::vector<std::string>{"count = 4", "count other than 4"}));
}

// Their cells in the unit cube are of other widths than those of values that are spread evenly.
TEST(Branches, KnowTheValuesOfLogarithmicIntegers) {
  SearchSpace space = pictures();
  space.variables[0].is_log = true;
  const auto branches = branches_of(space);
  ASSERT_EQ(branches.size(), 2U);
  EXPECT_EQ(branches[0].name, "count other than 4");
  std::vector<double> counts;
  for (int k = 0; k < 9; ++k) {
    const std::vector<double> unit = {(k + 0.5) / 9.0, 0.25};
    const Point point = branches[0].point_at(space, unit);
    counts.push_back(point[0]);
    EXPECT_EQ(branches[0].unit_of(space, point)[0], unit[0]);
  }
  EXPECT_EQ(counts, (std::vector<double>{1, 2, 3, 5, 6, 7, 8, 9, 10}));
  EXPECT_EQ(branches[1].point_at(space, std::vector<double>{0.5, 0.5})[0], 4.0);
  EXPECT_EQ(branch_names(space, std::vector<Point>{{4, 0.2, 0.5}, {7, 0.5, 0.5}}),
            (std::vector<std::string>{"count = 4", "count other than 4"}));
}

/// A dome has an opening of its own, if it is open, and ring and bar have nothing.
TEST(Branches, AreSetsOfNestedConditions) {
  const SearchSpace space = {
      {{.name = "use", .kind = Kind::kChoice, .choices = {"ring", "dome", "bar"}},
       {.name = "is_open",
        .kind = Kind::kChoice,
        .choices = {"no", "yes"},
        .when_name = "use",
        .when_value = "dome"},
       {.name = "opening", .when_name = "is_open", .when_value = "yes"}}};
  std::vector<std::string> names;
  for (const Branch& branch : branches_of(space)) {
    names.push_back(branch.name);
  }
  EXPECT_THAT(names,
              testing::ElementsAre(
                  "use = ring or bar", "use = dome, is_open = no", "use = dome, is_open = yes"));
}

TEST(Branches, OfMoreThan256OnlyThoseWithDesignsAreMade) {
  SearchSpace space;
  for (int k = 0; k < 9; ++k) {
    const std::string name = "is_" + std::to_string(k);
    space.variables.push_back({.name = name, .kind = Kind::kChoice, .choices = {"no", "yes"}});
    space.variables.push_back(
        {.name = "of_" + std::to_string(k), .when_name = name, .when_value = "yes"});
  }
  const auto trials = evaluated(space, 30, [](const Point& point, int) { return point[1]; });
  const ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
  EXPECT_GT(analysis.branches.size(), 10U);
  EXPECT_LE(analysis.branches.size(), 30U);
  EXPECT_GT(analysis.wanted, 0);
  EXPECT_EQ(branches_of(space).size(), 1U) << "there is no design";
}

// By values there would be ten branches of a dozen designs each.
TEST(AnalyseScore, NeedsNoEvidenceForEachValueOfAConditionsVariable) {
  const SearchSpace space = pictures();
  const auto trials = evaluated(space, 120, [](const Point& point, int) {
    return point[0] + (point[0] == 4.0 ? point[1] : point[2]);
  });
  const ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
  ASSERT_EQ(analysis.branches.size(), 2U);
  const BranchAnalysis& others = analysis.branches[0];
  ASSERT_TRUE(others.evidence.is_enough()) << others.evidence.reason();
  EXPECT_EQ(others.importance[0].variable, 0U);
  EXPECT_GT(others.importance[0].index.total.value, 0.9);
  EXPECT_THAT(others.responses[0].at, testing::ElementsAre(1, 2, 3, 5, 6, 7, 8, 9, 10));
}

// Logarithmic values have cells of other widths: (k + 0.5) / 15 gives 2 three times and never 16.
TEST(AnalyseScore, ResponsesHaveEveryValueOfALogarithmicInteger) {
  const SearchSpace space = {
      {{.name = "n", .kind = Kind::kInteger, .low = 2.0, .high = 16.0, .is_log = true},
       {.name = "m", .kind = Kind::kInteger, .low = 1.0, .high = 10.0, .is_log = true}}};
  const auto trials = evaluated(space, 40, [](const Point& p, int) { return 2.0 * p[0] + p[1]; });
  const ScoreAnalysis analysis = analyse_score(space, kGoal, trials, "y");
  const BranchAnalysis& branch = analysis.branches[0];
  ASSERT_TRUE(branch.evidence.is_enough()) << branch.evidence.reason();
  const auto is_counted = testing::ElementsAre(2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
  EXPECT_THAT(branch.responses[0].at, is_counted);
  EXPECT_THAT(branch.responses[1].at, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10));
  ASSERT_TRUE(branch.map);
  EXPECT_THAT(branch.map->at_y, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10));
  // 15 values are too many here: of 13 even places the first three are 2, and two are 3.
  EXPECT_THAT(branch.map->at_x, testing::ElementsAre(2, 3, 4, 5, 6, 7, 9, 11, 14, 16));
  EXPECT_EQ(branch.map->values.size(), branch.map->at_x.size() * 10);
}

}  // namespace
}  // namespace glint
