// SPDX-License-Identifier: GPL-3.0-or-later
//
// The conformance suite: every algorithm name against every promise of
// optimizer/algorithm/algorithm.h.
#include "optimizer/algorithm/algorithm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

using test::box;
using test::mixed_space;
using test::mixed_value;

struct Asked {
  std::vector<Point> points;
  std::vector<double> merits;
};

/// What a run is told for its n-th question: noisy, and every seventh fails when asked to.
double told_merit(const SearchSpace& space, const Point& point, int n) {
  double value = 0.0;
  if (space.variables.size() == mixed_space().variables.size()) {
    value = mixed_value(point);
  } else {
    for (const double x : point) {
      value += (x - 0.3) * (x - 0.3) + 0.02 * (1.0 - std::cos(20.0 * x));
    }
  }
  return value + test::noise(n);
}

/// The merit with the exact derivatives of told_merit() without its noise.
Answer told_answer(const SearchSpace& space,
                   const Point& point,
                   double merit,
                   bool is_failed,
                   std::size_t num_objectives) {
  Answer answer{.merit = merit, .is_failed = is_failed, .objective = {.value = merit}};
  std::vector<double> gradient;
  if (space.variables.size() == mixed_space().variables.size()) {
    gradient = test::mixed_gradient(point);
  } else {
    for (const double x : point) {
      gradient.push_back(2.0 * (x - 0.3) + 0.4 * std::sin(20.0 * x));
    }
  }
  for (std::size_t i = 0; i < point.size(); ++i) {
    const double scale = derivative_at(space, point, i);
    answer.objective.gradient.push_back(scale == 0.0 ? 0.0 : scale * gradient[i]);
  }
  answer.objectives.assign(num_objectives, merit);
  if (num_objectives > 1) {
    answer.objectives.back() += point[0];
  }
  return answer;
}

/// Asks and tells `count` points; the first `recorded.points.size()` are told what was recorded.
Asked run_algorithm(const SearchSpace& space,
                    const SearchSettings& settings,
                    int count,
                    const Asked& recorded = {},
                    bool has_failures = false,
                    const std::vector<Point>& start_points = {}) {
  const std::unique_ptr<Algorithm> algorithm = test::make_for(space, settings, start_points);
  Asked asked;
  while (static_cast<int>(asked.points.size()) < count) {
    std::vector<Point> batch;
    for (int i = 0; i < settings.batch; ++i) {
      batch.push_back(*algorithm->ask());
    }
    for (const Point& point : batch) {
      const auto n = asked.points.size();
      double merit = n < recorded.merits.size() ? recorded.merits[n]
                                                : told_merit(space, point, static_cast<int>(n));
      const bool is_failed = has_failures && n % 7 == 3;
      if (is_failed) {
        merit = 5.0;
      }
      algorithm->tell(
          point,
          told_answer(
              space, point, merit, is_failed, test::num_objectives_for(settings.algorithm)));
      asked.points.push_back(point);
      asked.merits.push_back(merit);
    }
  }
  return asked;
}

class AnyAlgorithm : public testing::TestWithParam<std::string_view> {
 protected:
  SearchSettings settings(int batch = 1) const {
    return {.algorithm = std::string(GetParam()), .seed = 11, .batch = batch};
  }

  static SearchSpace mixed() { return test::mixed_space_for(GetParam()); }
};

TEST_P(AnyAlgorithm, AsksOnlyPointsThatTheSpaceAllows) {
  for (const SearchSpace& space : {box(6, 0, 1), box(1, -4, 2), box(2, 5, 6), mixed()}) {
    for (const Point& point : run_algorithm(space, settings(), 250).points) {
      ASSERT_TRUE(test::is_allowed(space, point));
    }
  }
}

TEST_P(AnyAlgorithm, AsksTheSameForTheSameSeed) {
  for (const int batch : {1, 4}) {
    const Asked once = run_algorithm(box(5, 0, 1), settings(batch), 120);
    const Asked again = run_algorithm(box(5, 0, 1), settings(batch), 120);
    EXPECT_EQ(once.points, again.points);
  }
}

TEST_P(AnyAlgorithm, ReplaysNoisyValuesBitForBitFromHalfWay) {
  for (const SearchSpace& space : {box(5, 0, 1), mixed()}) {
    const Asked full = run_algorithm(space, settings(3), 240);
    Asked half = full;
    half.points.resize(120);
    half.merits.resize(120);
    const Asked replayed = run_algorithm(space, settings(3), 240, half);
    EXPECT_EQ(replayed.points, full.points);
  }
}

TEST_P(AnyAlgorithm, SurvivesFailedEvaluations) {
  for (const SearchSpace& space : {box(4, 0, 1), mixed()}) {
    EXPECT_EQ(run_algorithm(space, settings(), 200, {}, true).points.size(), 200U);
  }
}

TEST_P(AnyAlgorithm, AsksStartPointsFirst) {
  const std::vector<Point> start = {{0.25, 0.5, 0.75}, {0.5, 0.125, 0.0}};
  const Asked asked = run_algorithm(box(3, 0, 1), settings(2), 40, {}, false, start);
  EXPECT_EQ(asked.points[0], start[0]);
  EXPECT_EQ(asked.points[1], start[1]);
}

TEST_P(AnyAlgorithm, KeepsFindingNewPoints) {
  for (const int batch : {1, 4}) {
    const Asked asked = run_algorithm(box(3, 0, 1), settings(batch), 400);
    const std::set<Point> unique(asked.points.begin(), asked.points.end());
    EXPECT_GE(unique.size(), 200U);
  }
}

TEST_P(AnyAlgorithm, TriesEveryChoice) {
  std::set<double> shapes;
  for (const Point& point : run_algorithm(mixed(), settings(), 60).points) {
    shapes.insert(point[4]);
  }
  EXPECT_EQ(shapes, (std::set<double>{0.0, 1.0, 2.0}));
}

// With a watchdog of an hour: who waited for it would still be here when the test runner gives up.
TEST_P(AnyAlgorithm, GoesAwayAtOnceWhenAbandonedInTheMiddle) {
  SearchSettings patient = settings(2);
  const std::size_t num_objectives = test::num_objectives_for(GetParam());
  patient.watchdog_s = 3600.0;
  for (const int count : {0, 1, 7, 30}) {
    const SearchSpace space = box(4, 0, 1);
    const std::unique_ptr<Algorithm> algorithm = test::make_for(space, patient, {});
    for (int i = 0; i < count; ++i) {
      const Point a = *algorithm->ask();
      const Point b = *algorithm->ask();
      algorithm->tell(a, told_answer(space, a, told_merit(space, a, i), false, num_objectives));
      algorithm->tell(b, told_answer(space, b, told_merit(space, b, i), false, num_objectives));
    }
    EXPECT_TRUE(algorithm->ask().has_value()) << count;
  }
}

TEST_P(AnyAlgorithm, CopesWithConstantValuesAndConstantVariables) {
  SearchSpace space = box(3, 0, 1);
  space.variables[1].low = 1.0;
  const std::unique_ptr<Algorithm> algorithm = test::make_for(space, settings(), {});
  for (int i = 0; i < 150; ++i) {
    const Point point = *algorithm->ask();
    ASSERT_TRUE(test::is_allowed(space, point));
    Answer answer{.merit = 1.0, .objective = {1.0, {0.0, 0.0, 0.0}}};
    answer.objectives.assign(needs_several_objectives(GetParam()) ? 2 : 1, 1.0);
    algorithm->tell(point, answer);
  }
}

INSTANTIATE_TEST_SUITE_P(Names,
                         AnyAlgorithm,
                         testing::ValuesIn(algorithm_names().begin(), algorithm_names().end()),
                         [](const auto& test) { return std::string(test.param); });

TEST(Algorithm, SamplingEndsWhenAFiniteSpaceIsExhausted) {
  const SearchSpace space = {
      {{.name = "n", .kind = Variable::Kind::kInteger, .low = 1, .high = 4},
       {.name = "c", .kind = Variable::Kind::kChoice, .choices = {"a", "b"}}}};
  for (const char* name : {"sobol", "random"}) {
    const auto algorithm = make_algorithm(space, {.algorithm = name}, {});
    std::set<Point> points;
    while (const std::optional<Point> point = algorithm->ask()) {
      points.insert(*point);
      algorithm->tell(*point, 0.0, false);
    }
    EXPECT_EQ(points.size(), 8U) << name;
  }
}

TEST(Algorithm, AutoStandsForWhatTheHeaderSays) {
  EXPECT_EQ(resolved_algorithm(box(1, 0, 1), {}), "direct_l");
  EXPECT_EQ(resolved_algorithm(box(2, 0, 1), {}), "direct_l");
  EXPECT_EQ(resolved_algorithm(box(3, 0, 1), {}), "bobyqa");
  EXPECT_EQ(resolved_algorithm(box(3, 0, 1), {.is_noisy = true}), "gp");
  EXPECT_EQ(resolved_algorithm(box(1, 0, 1), {.is_noisy = true}), "gp");
  EXPECT_EQ(resolved_algorithm(box(3, 0, 1), {.is_noisy = true, .rules = 1}), "cobyla");
  EXPECT_EQ(resolved_algorithm(mixed_space(), {.algorithm = "crs2"}), "crs2");
}

TEST(Algorithm, OnlyThreeNeedDerivatives) {
  std::set<std::string_view> names;
  for (const std::string_view name : algorithm_names()) {
    if (needs_gradient(name)) {
      names.insert(name);
    }
  }
  EXPECT_EQ(names, (std::set<std::string_view>{"slsqp", "mma", "lbfgs"}));
}

TEST(Algorithm, DerivativesRefuseRoundedFloatsByName) {
  for (const char* name : {"slsqp", "mma", "lbfgs"}) {
    try {
      make_algorithm(mixed_space(), {.algorithm = name}, {});
      FAIL() << name;
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("variable \"angle\": has a step of 7.5"));
      EXPECT_THAT(error.what(), testing::HasSubstr(name));
    }
    EXPECT_NO_THROW(make_algorithm(test::smooth_mixed_space(), {.algorithm = name}, {}));
  }
}

TEST(Algorithm, DesignSizeIsAsDocumented) {
  EXPECT_EQ(design_size(box(2, 0, 1), {}), 8);             // 2 * 2 + 2 = 6 < 8
  EXPECT_EQ(design_size(box(6, 0, 1), {}), 14);            // 2 * 6 + 2
  EXPECT_EQ(design_size(box(6, 0, 1), {.batch = 4}), 16);  // whole batches
  EXPECT_EQ(design_size(mixed_space(), {}), 64);           // 4 * 10 * 3 * 8 = 960, at most 64
  EXPECT_EQ(design_size(mixed_space(), {.design = 20}), 20);
}

TEST(Algorithm, RefusesWrongSettings) {
  const auto message = [](const SearchSettings& settings) -> std::string {
    try {
      make_algorithm(box(3, 0, 1), settings, {});
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message({.algorithm = "bobyka"}), HasSubstr("did you mean \"bobyqa\""));
  EXPECT_THAT(message({.batch = 0}), HasSubstr("batch"));
  EXPECT_THAT(message({.tolerance = 0.0}), HasSubstr("tolerance"));
  EXPECT_THAT(message({.watchdog_s = 0.0}), HasSubstr("watchdog"));
  EXPECT_THROW(make_algorithm({}, {}, {}), ConfigError);
}

}  // namespace
}  // namespace glint
