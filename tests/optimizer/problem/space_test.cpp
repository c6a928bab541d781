// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/problem/space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "core/rng.h"
#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

using Kind = Variable::Kind;
using ::testing::HasSubstr;

std::vector<double> random_unit(const SearchSpace& space, std::uint64_t index) {
  Rng rng(5, Stream::kTest, index);
  std::vector<double> unit(space.variables.size());
  for (double& value : unit) {
    value = rng.uniform();
  }
  return unit;
}

std::string space_error(const Variable& variable) {
  try {
    check(SearchSpace{{variable}});
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(SearchSpace, MapsHandWorkedUnitValues) {
  const SearchSpace space = {
      {{.name = "a", .low = -2.0, .high = 6.0},                         // -2 + 0.75 * 8 = 4
       {.name = "b", .low = 1.0, .high = 100.0, .is_log = true},        // 10^(2 * 0.5) = 10
       {.name = "c", .low = 0.0, .high = 10.0, .step = 2.5},            // 6.0 -> 5.0 (2 steps)
       {.name = "d", .kind = Kind::kInteger, .low = 3.0, .high = 6.0},  // 4 cells, 0.74 -> 3rd
       {.name = "e", .kind = Kind::kInteger, .low = 4, .high = 24, .step = 4},  // 6 cells, 0.34 ->
                                                                                // 3rd
       {.name = "f", .kind = Kind::kChoice, .choices = {"x", "y", "z"}}}};  // 3 cells, 0.67 -> 3rd
  const Point point = point_from_unit(space, std::vector<double>{0.75, 0.5, 0.6, 0.74, 0.34, 0.67});
  EXPECT_DOUBLE_EQ(point[0], 4.0);
  EXPECT_NEAR(point[1], 10.0, 1e-12);
  EXPECT_EQ(point[2], 5.0);
  EXPECT_EQ(point[3], 5.0);
  EXPECT_EQ(point[4], 12.0);
  EXPECT_EQ(point[5], 2.0);
}

TEST(SearchSpace, EndsOfTheCubeAreTheLimitsExactly) {
  const SearchSpace space = {
      {{.name = "a", .low = 0.3, .high = 0.7, .is_log = true},
       {.name = "b", .kind = Kind::kInteger, .low = 1, .high = 64, .is_log = true},
       {.name = "c", .low = 0.0, .high = 1.0, .step = 0.3}}};
  EXPECT_EQ(point_from_unit(space, std::vector<double>{0, 0, 0}), (Point{0.3, 1.0, 0.0}));
  // The last step that fits into [0, 1] is 0.9.
  EXPECT_EQ(point_from_unit(space, std::vector<double>{1, 1, 1}), (Point{0.7, 64.0, 3 * 0.3}));
  EXPECT_EQ(point_from_unit(space, std::vector<double>{7, 9, 5}), (Point{0.7, 64.0, 3 * 0.3}));
}

TEST(SearchSpace, InactiveVariablesCarryTheirMiddle) {
  const SearchSpace space = test::mixed_space();
  // Shape 0.5 is "round": the radius counts, the knots (2..9, middle cell 5 of 8 = 6) do not.
  Point point = point_from_unit(space, std::vector<double>{0, 0, 0, 0, 0.5, 0.25, 0.9});
  EXPECT_DOUBLE_EQ(point[5], 12.5);
  EXPECT_EQ(point[6], 6.0);
  EXPECT_TRUE(is_active(space, point, 5));
  EXPECT_FALSE(is_active(space, point, 6));
  // Shape 0 is "flat": neither counts.
  point = point_from_unit(space, std::vector<double>{0, 0, 0, 0, 0.0, 0.25, 0.9});
  EXPECT_EQ(point[5], 15.0);
  EXPECT_EQ(point[6], 6.0);
}

TEST(SearchSpace, AConditionCanHangOnAnother) {
  const SearchSpace space = {
      {{.name = "deep", .low = 0, .high = 1, .when_name = "count", .when_value = "2"},
       {.name = "kind", .kind = Kind::kChoice, .choices = {"none", "some"}},
       {.name = "count",
        .kind = Kind::kInteger,
        .low = 1,
        .high = 3,
        .when_name = "kind",
        .when_value = "some"}}};
  check(space);
  EXPECT_TRUE(is_active(space, Point{0.1, 1, 2}, 0));
  EXPECT_FALSE(is_active(space, Point{0.1, 1, 3}, 0));
  // The middle of count is 2, but count itself is not active.
  EXPECT_FALSE(is_active(space, Point{0.1, 0, 2}, 0));
  EXPECT_EQ(canonical(space, Point{0.1, 0, 3}), (Point{0.5, 0, 2}));
}

TEST(SearchSpace, AConditionMayHoldForSeveralValues) {
  const Variable kind = {.name = "kind", .kind = Kind::kChoice, .choices = {"a", "b", "c"}};
  const Variable on = {.name = "x", .when_name = "kind", .when_value = "a", .when_others = {"c"}};
  const SearchSpace space = {{kind, on}};
  check(space);
  EXPECT_TRUE(is_active(space, Point{0, 0.2}, 1));
  EXPECT_FALSE(is_active(space, Point{1, 0.2}, 1));
  EXPECT_TRUE(is_active(space, Point{2, 0.2}, 1));
  EXPECT_EQ(canonical(space, Point{1, 0.2}), (Point{1, 0.5}));
  Variable wrong = on;
  wrong.when_others = {"d"};
  EXPECT_THROW(check(SearchSpace{{kind, wrong}}), ConfigError);
}

TEST(SearchSpace, PointsAreAllowedAndStayAsTheyAreThroughTheCube) {
  const SearchSpace space = test::mixed_space();
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Point point = point_from_unit(space, random_unit(space, i));
    ASSERT_EQ(canonical(space, point), point);
    for (std::size_t k = 0; k < point.size(); ++k) {
      const Variable& v = space.variables[k];
      const bool is_choice = v.kind == Kind::kChoice;
      ASSERT_GE(point[k], is_choice ? 0.0 : v.low);
      ASSERT_LE(point[k], is_choice ? 2.0 : v.high);
    }
    ASSERT_EQ(point[3], std::floor(point[3]));
    ASSERT_EQ(point[2], 7.5 * std::round(point[2] / 7.5));
    const Point again = point_from_unit(space, unit_from_point(space, point));
    for (std::size_t k = 0; k < point.size(); ++k) {
      ASSERT_NEAR(again[k], point[k], 1e-12 * (1.0 + std::abs(point[k]))) << k;
    }
  }
}

TEST(SearchSpace, EveryDiscreteValueIsEquallyLikely) {
  const SearchSpace space = {
      {{.name = "n", .kind = Kind::kInteger, .low = 1, .high = 5},
       {.name = "c", .kind = Kind::kChoice, .choices = {"a", "b", "c", "d"}}}};
  std::vector<int> integers(6);
  std::vector<int> choices(4);
  for (int i = 0; i < 1000; ++i) {
    const double u = (i + 0.5) / 1000.0;
    const Point point = point_from_unit(space, std::vector<double>{u, u});
    ++integers[static_cast<std::size_t>(point[0])];
    ++choices[static_cast<std::size_t>(point[1])];
  }
  EXPECT_EQ(integers, (std::vector<int>{0, 200, 200, 200, 200, 200}));
  EXPECT_EQ(choices, (std::vector<int>{250, 250, 250, 250}));
}

TEST(SearchSpace, CanonicalClampsRoundsAndReplacesNaN) {
  const SearchSpace space = test::mixed_space();
  const Point point = canonical(space, Point{99, -1, 10.9, 7.4, 1, std::nan(""), 5});
  EXPECT_EQ(point, (Point{5.0, 0.1, 7.5, 7.0, 1.0, 15.0, 6.0}));
  EXPECT_FALSE(std::signbit(canonical(test::box(1, -1, 1), Point{-0.0})[0]));
}

TEST(SearchSpace, KnowsContinuousVariablesAndCountsValues) {
  const SearchSpace space = test::mixed_space();
  std::vector<std::string> continuous;
  for (const Variable& variable : space.variables) {
    if (is_continuous(variable)) {
      continuous.push_back(variable.name);
    }
  }
  EXPECT_THAT(continuous, testing::ElementsAre("length", "period", "angle", "radius"));
  EXPECT_EQ(num_values(space.variables[2]), 13.0);  // 0, 7.5, ..., 90
  EXPECT_EQ(num_values(space.variables[3]), 10.0);
  EXPECT_EQ(num_values(space.variables[4]), 3.0);
  EXPECT_TRUE(std::isinf(num_values(space.variables[0])));
  EXPECT_EQ(num_values({.name = "one", .low = 2, .high = 2}), 1.0);
}

TEST(SearchSpace, RefusesWrongNumbers) {
  EXPECT_THAT(space_error({.name = "a", .low = 2, .high = 1}), HasSubstr("min 2 is above max 1"));
  EXPECT_THAT(space_error({.name = "a", .low = 0, .high = 1, .is_log = true}), HasSubstr("log"));
  EXPECT_THAT(space_error({.name = "a", .step = -1}), HasSubstr("step -1 must be positive"));
  EXPECT_THAT(space_error({.name = "a", .step = 2}), HasSubstr("at most the range 1"));
  EXPECT_THAT(space_error({.name = "a", .kind = Kind::kInteger, .low = 0.5, .high = 2}),
              HasSubstr("whole numbers"));
  EXPECT_THAT(space_error({.name = "a", .high = std::numeric_limits<double>::infinity()}),
              HasSubstr("finite"));
  EXPECT_EQ(space_error({.name = "a", .low = 2, .high = 2}), "");
}

TEST(SearchSpace, RefusesWrongChoicesAndNames) {
  EXPECT_THAT(space_error({.name = "a", .kind = Kind::kChoice}), HasSubstr("choices is empty"));
  EXPECT_THAT(space_error({.name = "a", .kind = Kind::kChoice, .choices = {"x", "x"}}),
              HasSubstr("twice"));
  EXPECT_THAT(space_error({}), HasSubstr("needs a name"));
  EXPECT_THROW(check(SearchSpace{{{.name = "a"}, {.name = "a"}}}), ConfigError);
}

TEST(SearchSpace, RefusesWrongConditions) {
  EXPECT_THAT(space_error({.name = "a", .when_name = "b", .when_value = "1"}),
              HasSubstr("unknown variable \"b\""));
  EXPECT_THAT(
      space_error({.name = "a", .kind = Kind::kInteger, .when_name = "a", .when_value = "1"}),
      HasSubstr("itself"));
  const auto message = [](const SearchSpace& space) -> std::string {
    try {
      check(space);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  const Variable shape = {.name = "shape", .kind = Kind::kChoice, .choices = {"flat", "round"}};
  EXPECT_THAT(message({{shape, {.name = "r", .when_name = "shape", .when_value = "rond"}}}),
              HasSubstr("never is, allowed: flat, round"));
  EXPECT_THAT(message({{shape, {.name = "r", .when_name = "shpe", .when_value = "flat"}}}),
              HasSubstr("did you mean \"shape\""));
  EXPECT_THAT(message({{{.name = "x"}, {.name = "r", .when_name = "x", .when_value = "0.5"}}}),
              HasSubstr("needs a choice"));
  const Kind integer = Kind::kInteger;
  EXPECT_THAT(
      message({{{.name = "p", .kind = integer, .high = 3, .when_name = "q", .when_value = "1"},
                {.name = "q", .kind = integer, .high = 3, .when_name = "p", .when_value = "1"}}}),
      HasSubstr("circle"));
}

TEST(SearchSpace, ReportsAllProblemsAtOnce) {
  try {
    check(SearchSpace{{{.name = "a", .low = 2, .high = 1}, {.name = "b", .step = -1}}});
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"a\""));
    EXPECT_THAT(error.what(), HasSubstr("\"b\""));
  }
}

TEST(DerivativeAt, IsTheHandWorkedDerivative) {
  const SearchSpace space = test::smooth_mixed_space();
  Point point = {1.0, 10.0, 30.0, 5.0, 1.0, 12.0, 6.0};   // shape "round": radius is active
  EXPECT_DOUBLE_EQ(derivative_at(space, point, 0), 8.0);  // 5 - -3
  EXPECT_NEAR(derivative_at(space, point, 1), 10.0 * std::log(1e3), 1e-12);  // p * ln(100 / 0.1)
  EXPECT_DOUBLE_EQ(derivative_at(space, point, 2), 90.0);
  EXPECT_EQ(derivative_at(space, point, 3), 0.0);  // an integer
  EXPECT_EQ(derivative_at(space, point, 4), 0.0);  // a choice
  EXPECT_DOUBLE_EQ(derivative_at(space, point, 5), 10.0);
  point[4] = 0.0;
  EXPECT_EQ(derivative_at(space, point, 5), 0.0);                // inactive now
  EXPECT_EQ(derivative_at(test::mixed_space(), point, 2), 0.0);  // rounded
}

}  // namespace
}  // namespace glint
