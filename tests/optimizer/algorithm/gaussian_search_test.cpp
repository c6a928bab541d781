// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/gaussian_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "optimizer/front/front.h"
#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

TEST(LogExpectedImprovement, AgreesWithTheFormulaAndItsTail) {
  // z = 1: phi + Phi = 0.241971 + 0.841345 = 1.083316; times sigma 2.
  EXPECT_NEAR(log_expected_improvement(3.0, 1.0, 2.0), std::log(2.166632), 1e-6);
  const double before = log_expected_improvement(-5.999, 0.0, 1.0);
  const double after = log_expected_improvement(-6.001, 0.0, 1.0);
  EXPECT_NEAR(before, after, 0.05);
  EXPECT_LT(log_expected_improvement(-40.0, 0.0, 1.0), after);
  EXPECT_NEAR(log_normal_probability(-5.999), log_normal_probability(-6.001), 0.02);
  EXPECT_NEAR(log_normal_probability(0.0), std::log(0.5), 1e-15);
}

TEST(GaussianSearch, EndsWhenAFiniteSpaceIsExhausted) {
  const SearchSpace space = {
      {{.name = "n", .kind = Variable::Kind::kInteger, .low = 1, .high = 6},
       {.name = "c", .kind = Variable::Kind::kChoice, .choices = {"a", "b", "c"}}}};
  const auto algorithm = make_algorithm(space, {.algorithm = "gp"}, {});
  std::set<Point> points;
  while (const std::optional<Point> point = algorithm->ask()) {
    EXPECT_TRUE(points.insert(*point).second);
    algorithm->tell(*point, (*point)[0], false);
  }
  EXPECT_EQ(points.size(), 18U);
}

/// Minimise the sum; the limit wants x0 + x1 >= 1, in parts of it: the optimum is 1.
TEST(GaussianSearch, KeepsToALimitByItsProbability) {
  const auto algorithm = make_algorithm(test::box(2, 0, 1), {.algorithm = "gp"}, {}, 1);
  double best = 1e9;
  for (int i = 0; i < 50; ++i) {
    const Point point = *algorithm->ask();
    const double sum = point[0] + point[1];
    algorithm->tell(point, {.merit = sum, .objective = {sum}, .limits = {{1.0 - sum, {}}}});
    best = sum >= 1.0 ? std::min(best, sum) : best;
  }
  EXPECT_LT(best, 1.02);
}

TEST(GaussianSearch, FindsTheBestBesideWhatFails) {
  const auto algorithm = make_algorithm(test::box(2, 0, 1), {.algorithm = "gp"}, {});
  double best = 1e9;
  for (int i = 0; i < 60; ++i) {
    const Point point = *algorithm->ask();
    const bool is_failed = point[0] > 0.5;  // that is where the objective falls to
    const double value = 1.0 - point[0] + point[1];
    best = is_failed ? best : std::min(best, value);
    algorithm->tell(point, value, is_failed);
  }
  EXPECT_LT(best, 0.55);
}

/// f1 = |x - a|^2, f2 = |x - b|^2 in four dimensions: the front lies between a and b.
TEST(GaussianSearch, FindsAFrontThatRandomSamplingDoesNot) {
  const auto found = [](const char* name) {
    const auto algorithm = make_algorithm(test::box(4, 0, 1), {.algorithm = name}, {}, 0, 2);
    std::vector<std::vector<double>> rows;
    for (int i = 0; i < 60; ++i) {
      const Point point = *algorithm->ask();
      std::vector<double> objectives(2, 0.0);
      for (const double x : point) {
        objectives[0] += (x - 0.3) * (x - 0.3);
        objectives[1] += (x - 0.7) * (x - 0.7);
      }
      rows.push_back(objectives);
      algorithm->tell(point, {.merit = objectives[0], .objectives = objectives});
    }
    return hypervolume(rows, std::vector<double>{0.7, 0.7});
  };
  EXPECT_GT(found("gp"), 0.36);
  EXPECT_GT(found("gp"), found("random"));
  EXPECT_EQ(found("auto"), found("gp"));
}

/// What a program asked before there were rules; runs that it began go on so.
TEST(GaussianSearch, ByRules1AsksWhatEarlierProgramsAsked) {
  const SearchSpace space = {
      {{.name = "a"}, {.name = "b"}, {.name = "n", .low = 1.0, .high = 9.0}}};
  const std::vector<std::vector<Point>> asked = {
      {{0.34178090672424882, 0.5368499754585494, 1.0},
       {0.30397055584492416, 0.62349805563189376, 1.0},
       {0.0, 0.9006794761996787, 1.0},
       {0.35363800318329153, 0.61544378920312948, 1.0}},
      {{0.48567422074567096, 0.38930096191266633, 2.8458184510869788},
       {0.53668442073145994, 0.34808199875647822, 2.9469860156196601},
       {0.53400109035511922, 0.35925028309017015, 2.766337683593747},
       {0.48985571210185047, 0.38472224146053868, 1.1489092061354209}}};
  for (const int num_objectives : {1, 2}) {
    const auto algorithm = make_algorithm(
        space,
        {.algorithm = "gp", .seed = 4, .is_noisy = num_objectives == 1, .design = 8, .rules = 1},
        {},
        0,
        num_objectives);
    EXPECT_FALSE(algorithm->can_restore());
    for (std::size_t i = 0; i < 16; ++i) {
      const Point p = *algorithm->ask();
      if (i >= 12) {
        const Point& before = asked[static_cast<std::size_t>(num_objectives - 1)][i - 12];
        for (std::size_t k = 0; k < p.size(); ++k) {
          EXPECT_NEAR(p[k], before[k], 1e-9) << i;
        }
      }
      const double f1 = std::pow(p[0] - 0.3, 2) + std::pow(p[1] - 0.6, 2) + 0.01 * p[2];
      const double f2 = std::pow(p[0] - 0.8, 2) + std::pow(p[1] - 0.1, 2) + 0.01 * (9 - p[2]);
      Answer answer{.merit = f1, .objective = {f1, {}}, .objectives = {f1, f2}};
      answer.objectives.resize(static_cast<std::size_t>(num_objectives));
      algorithm->tell(p, answer);
    }
  }
}

TEST(GaussianSearch, OtherMethodsRefuseSeveralObjectives) {
  EXPECT_THROW(make_algorithm(test::box(2, 0, 1), {.algorithm = "cobyla"}, {}, 0, 2), ConfigError);
}

TEST(GaussianSearch, GoesOnBeyondWhatItsModelsHold) {
  const auto sobol = make_algorithm(test::box(2, 0, 1), {.algorithm = "sobol", .seed = 5}, {});
  std::vector<Point> starts;
  for (int i = 0; i < 830; ++i) {
    starts.push_back(*sobol->ask());
  }
  const auto fed =
      make_algorithm(test::box(2, 0, 1), {.algorithm = "gp", .is_noisy = true}, starts);
  for (int i = 0; i < 832; ++i) {
    const std::optional<Point> point = fed->ask();
    ASSERT_TRUE(point.has_value());
    fed->tell(*point, (*point)[0] + test::noise(i), false);
  }
  EXPECT_TRUE(fed->ask().has_value());
}

}  // namespace
}  // namespace glint
