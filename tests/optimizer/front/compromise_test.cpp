// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/front/compromise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "optimizer/front/choice_cost.h"

namespace glint {
namespace {

using Rows = std::vector<std::vector<double>>;

/// In parts of the ranges: (0, 1), (0.1, 0.5), (0.3, 0.25), (1, 0).
const Rows kFront = {{10, 4}, {11, 2}, {13, 1}, {20, 0}};

TEST(Compromise, GivesUpPartsOfTheFrontsRange) {
  const std::vector<ObjectiveRange> ranges = objective_ranges(kFront);
  Rows parts;
  for (const std::vector<double>& row : kFront) {
    parts.push_back(parts_of(row, ranges));
  }
  EXPECT_EQ(parts[0], (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(parts[1], (std::vector<double>{0.1, 0.5}));
  EXPECT_EQ(parts[2], (std::vector<double>{0.3, 0.25}));
  EXPECT_EQ(parts[3], (std::vector<double>{1.0, 0.0}));
}

/// Squared distances 1, 0.26, 0.1525, 1.
TEST(Compromise, TheKneeIsNearestToTheBestOfAll) {
  EXPECT_EQ(compromise_of(kFront, {}), 2U);
}

/// a + b: 1, 0.6, 0.55, 1; 20 a + b: 1, 2.5, 6.25, 20; a + 20 b: 20, 10.1, 5.3, 1.
TEST(Compromise, WeightsCountWhatIsGivenUp) {
  const auto by = [](double a, double b) {
    return compromise_of(kFront, {.rule = ChoiceRule::kWeights, .weights = {a, b}});
  };
  EXPECT_EQ(by(20.0, 1.0), 0U);
  EXPECT_EQ(by(1.0, 20.0), 3U);
  EXPECT_EQ(by(1.0, 1.0), 2U);
}

TEST(Compromise, AspirationsAreReachedOrMissedByLeast) {
  const auto of = [](std::optional<double> a, std::optional<double> b) {
    return compromise_of(kFront, {.rule = ChoiceRule::kAspirations, .aspirations = {a, b}});
  };
  EXPECT_EQ(of(11.0, 2.0), 1U);  // reached by one design alone
  EXPECT_EQ(of(20.0, 4.0), 2U);  // reached by all: the knee
  EXPECT_EQ(of(12.0, {}), 1U);   // by two, of which the second is nearer to the best
  EXPECT_EQ(of(10.0, 0.0), 2U);  // by none: shortfalls 1, 0.5, 0.3, 1
}

TEST(Compromise, OneDesignOrAnObjectiveWithoutRangeIsNoMistake) {
  EXPECT_EQ(compromise_of(Rows{{3, 7}}, {}), 0U);
  EXPECT_EQ(
      compromise_of(Rows{{3, 7}}, {.rule = ChoiceRule::kAspirations, .aspirations = {1.0, 1.0}}),
      0U);
  const Rows alone = {{3, 7}};
  EXPECT_EQ(parts_of(alone[0], objective_ranges(alone)), (std::vector<double>{0.0, 0.0}));
}

/// With ranges of more designs: 20 is half a range from the best and 1 a tenth, so that the ends of
/// the rows do not move what is taken.
TEST(Compromise, RangesMayComeFromElsewhere) {
  const std::vector<ObjectiveRange> ranges = {{.best = 0, .width = 40}, {.best = 0, .width = 20}};
  EXPECT_EQ(objective_ranges(kFront)[0].best, 10.0);
  EXPECT_EQ(objective_ranges(kFront)[0].width, 10.0);
  EXPECT_EQ(compromise_of(kFront, objective_ranges(kFront), {}), compromise_of(kFront, {}));
  // Squared distances 0.0625 + 0.04, 0.0756 + 0.01, 0.1056 + 0.0025, 0.25.
  EXPECT_EQ(compromise_of(kFront, ranges, {}), 1U);
  EXPECT_NEAR(choice_cost(kFront[1], ranges, {}), std::sqrt(0.275 * 0.275 + 0.01), 1e-12);
  EXPECT_EQ(choice_cost(std::vector<double>{-5, -5}, ranges, {}), 0.0) << "better than the best";
  const FrontChoice hopes = {.rule = ChoiceRule::kAspirations, .aspirations = {14.0, {}}};
  EXPECT_NEAR(choice_cost(kFront[0], ranges, hopes), -0.1, 1e-12) << "reached, by 4 of 40";
  EXPECT_EQ(choice_order(kFront[0], ranges, hopes)[0], 0.0) << "by how much does not count";
}

}  // namespace
}  // namespace glint
