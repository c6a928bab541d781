// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/rung_choice.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace glint {
namespace {

/// Two scores of four designs; errors of the rungs against the top are given.
TriedRung rung_with(const std::string& name, double work, double bias, double spread) {
  TriedRung rung{name, work, {{1.0, 2.0, 3.0, 4.0}, {0.4, 0.3, 0.2, 0.1}}};
  for (std::vector<double>& score : rung.scores) {
    for (std::size_t i = 0; i < score.size(); ++i) {
      score[i] += bias + (i % 2 == 0 ? spread : -spread);
    }
  }
  return rung;
}

std::vector<TriedRung> ladder() {
  return {rung_with("mirror", 1.0, 0.5, 0.0),
          rung_with("direct", 10.0, 0.01, 0.001),
          rung_with("paths", 100.0, 0.0, 0.0)};
}

std::vector<ScoreTolerance> tolerances(double h_points) {
  return {{"homogeneity.h_rms", h_points}, {"defects.min_cnr", 1.0}};
}

TEST(ChooseByTolerance, TakesTheCheapestRungInside) {
  const std::vector<TriedRung> rungs = ladder();
  EXPECT_EQ(choose_by_tolerance(rungs, tolerances(0.6), 0.99).rung, 0U);
  EXPECT_EQ(choose_by_tolerance(rungs, tolerances(0.1), 0.99).rung, 1U);
  EXPECT_EQ(choose_by_tolerance(rungs, tolerances(0.001), 0.99).rung, 2U);
}

TEST(ChooseByTolerance, HoldsEveryScore) {
  std::vector<ScoreTolerance> strict = tolerances(10.0);
  strict[1].tolerance = 0.1;
  EXPECT_EQ(choose_by_tolerance(ladder(), strict, 0.99).rung, 1U);
}

// Of little bias and much spread: what was seen is inside, what is to be expected is not.
TEST(ChooseByTolerance, LooksBeyondTheDesignsThatWereTried) {
  const std::vector<TriedRung> rungs = {rung_with("noisy", 1.0, 0.0, 0.09),
                                        rung_with("paths", 100.0, 0.0, 0.0)};
  const RungChoice choice = choose_by_tolerance(rungs, tolerances(0.1), 0.99);
  EXPECT_GT(choice.bounds[0][0].bound, 0.1);
  EXPECT_EQ(choice.rung, 1U);
}

// The order of a ladder is from cheap to dear, but the work decides.
TEST(ChooseByTolerance, GoesByWorkAndTakesTheFirstOfEqualRungs) {
  std::vector<TriedRung> rungs = ladder();
  rungs[0].work = 1000.0;
  EXPECT_EQ(choose_by_tolerance(rungs, tolerances(0.6), 0.99).rung, 1U);
  rungs[0].work = rungs[1].work;
  EXPECT_EQ(choose_by_tolerance(rungs, tolerances(0.6), 0.99).rung, 0U);
}

TEST(UnreachedTolerances, SayTheBoundThatIsToBeHad) {
  const std::vector<TriedRung> rungs = ladder();
  const std::vector<ScoreTolerance> allowed = tolerances(0.001);
  const RungChoice choice = choose_by_tolerance(rungs, allowed, 0.99);
  const std::vector<std::string> lines = unreached_tolerances(rungs, allowed, choice);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("homogeneity.h_rms: 0.001 is not reachable below 'paths'"));
  EXPECT_NE(lines[0].find("'direct' reaches 0.0"), std::string::npos) << lines[0];
  EXPECT_TRUE(unreached_tolerances(rungs, tolerances(0.1), choice).empty());
}

TriedRung ordered(const std::string& name, double work, std::vector<double> figures) {
  return {name, work, {std::move(figures)}};
}

TEST(ChooseByOrder, TakesTheCheapestWhoseOrderIsRight) {
  const std::array errors = {0.01, 0.01, 0.01, 0.01};
  const std::vector<TriedRung> rungs = {ordered("mirror", 1.0, {4.0, 3.0, 2.0, 1.0}),
                                        ordered("direct", 10.0, {11.0, 12.0, 13.0, 14.0}),
                                        ordered("paths", 100.0, {1.0, 2.0, 3.0, 4.0})};
  const OrderChoice choice = choose_by_order(rungs, errors);
  EXPECT_EQ(choice.rung, 1U);
  EXPECT_EQ(choice.agreements[0].tau, -1.0);
  EXPECT_EQ(choice.agreements[1].tau, 1.0);
}

// Where the top itself cannot tell designs apart no cheaper rung has shown anything.
TEST(ChooseByOrder, StaysAtTheTopWithoutEvidence) {
  const std::array errors = {9.0, 9.0, 9.0, 9.0};
  const std::vector<TriedRung> rungs = {ordered("mirror", 1.0, {1.0, 2.0, 3.0, 4.0}),
                                        ordered("paths", 100.0, {1.0, 2.0, 3.0, 4.0})};
  EXPECT_EQ(choose_by_order(rungs, errors).rung, 1U);
}

TEST(RungChoiceDeathTest, RefusesLaddersThatDoNotFit) {
  std::vector<TriedRung> rungs = ladder();
  EXPECT_DEATH(choose_by_tolerance({}, {}, 0.99), "has rungs");
  EXPECT_DEATH(choose_by_tolerance(rungs, {}, 0.99), "one tolerance");
  rungs[0].scores[0].pop_back();
  EXPECT_DEATH(choose_by_tolerance(rungs, tolerances(0.1), 0.99), "same designs");
  EXPECT_DEATH(choose_by_order(ladder(), {}), "one figure");
}

}  // namespace
}  // namespace glint
