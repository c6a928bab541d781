// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/best_designs.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "optimizer/algorithm/sobol.h"

namespace glint {
namespace {

/// x from 10 to 20, and one that does nothing.
SearchSpace lucky_box() {
  return {{{.name = "x", .low = 10.0, .high = 20.0}, {.name = "idle"}}};
}

double standard_normal(std::uint64_t index) {
  return Rng(31, Stream::kTest, index).normal();
}

/// Sixty even designs. @param noise  standard deviations of gain = x and of size = x / 10 - 0.5
std::vector<Trial> noisy_trials(double of_gain, double of_size) {
  const Sobol even(5, 2);
  std::vector<Trial> trials;
  for (std::uint32_t k = 0; k < 60; ++k) {
    const Point point = point_from_unit(lucky_box(), even.point(k));
    const double gain = point[0] + of_gain * standard_normal(2 * k);
    const double size = 0.1 * point[0] - 0.5 + of_size * standard_normal(2 * k + 1);
    trials.push_back({.number = static_cast<int>(k) + 1,
                      .point = point,
                      .outcome = Outcome{.scores = {{"gain", gain}, {"size", size}}}});
  }
  return trials;
}

std::vector<FittedScore> fits_of(const std::vector<Trial>& trials) {
  return {fit_score(lucky_box(), trials, "gain"), fit_score(lucky_box(), trials, "size")};
}

const Goal kMostGain = {.objective = {.name = "gain", .is_maximised = true}, .constraints = {}};

// Truly 14.5, seen as 26: eleven standard deviations of the noise too good, and beyond the best
// design, 20, by six. Among sixty designs the model takes that for noise.
TEST(BestDesigns, UnderNoiseAreNotTheLuckiest) {
  std::vector<Trial> trials = noisy_trials(1.0, 0.0);
  trials[7].point[0] = 14.5;
  trials[7].outcome->scores["gain"] = 26.0;
  EXPECT_EQ(best_seen(lucky_box(), kMostGain, trials).at("")[0], 14.5);
  EXPECT_GT(best_expected(lucky_box(), kMostGain, trials, fits_of(trials), {}).at("")[0], 18.0);
}

// The limit, size at most 1, holds up to x = 15; at x = 19 it is 1.4, and was seen as 0.9.
TEST(BestDesigns, UnderNoiseKeepLimitsProbably) {
  std::vector<Trial> trials = noisy_trials(0.0, 0.1);
  trials[7].point[0] = 19.0;
  trials[7].outcome->scores = {{"gain", 19.0}, {"size", 0.9}};
  Goal goal = kMostGain;
  goal.constraints = {{.name = "size", .min = {}, .max = 1.0}};
  const std::vector<FittedScore> fits = fits_of(trials);
  EXPECT_EQ(best_seen(lucky_box(), goal, trials).at("")[0], 19.0);
  const double expected = best_expected(lucky_box(), goal, trials, fits, {}).at("")[0];
  EXPECT_GT(expected, 14.0);
  EXPECT_LT(expected, 16.0);
  const std::vector<std::string> exact = {"size"};
  EXPECT_EQ(best_expected(lucky_box(), goal, trials, fits, exact).at("")[0], 19.0)
      << "what noise does not move is as it was seen";
}

TEST(BestDesigns, OfABranchWithoutAFeasibleDesignThereIsNone) {
  const std::vector<Trial> trials = noisy_trials(0.0, 0.0);
  Goal goal = kMostGain;
  goal.constraints = {{.name = "size", .min = 3.0, .max = {}}};
  EXPECT_TRUE(best_seen(lucky_box(), goal, trials).empty());
  EXPECT_TRUE(best_expected(lucky_box(), goal, trials, fits_of(trials), {}).empty());
}

// Both objectives are least at x = 10 but for a lucky design at 17, which would be the whole front.
TEST(BestDesigns, OfSeveralObjectivesAreTheCompromiseOfWhatIsExpected) {
  std::vector<Trial> trials = noisy_trials(0.5, 0.05);
  trials[7].point[0] = 17.0;
  trials[7].outcome->scores = {{"gain", 8.0}, {"size", 0.3}};
  const Goal goal = {.objective = {.name = "gain", .is_maximised = false},
                     .constraints = {},
                     .more_objectives = {{.name = "size", .is_maximised = false}}};
  EXPECT_EQ(best_seen(lucky_box(), goal, trials).at("")[0], 17.0);
  EXPECT_LT(best_expected(lucky_box(), goal, trials, fits_of(trials), {}).at("")[0], 12.0);
}

}  // namespace
}  // namespace glint
