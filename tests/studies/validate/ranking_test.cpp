// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/ranking.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace glint
