// SPDX-License-Identifier: GPL-3.0-or-later
//
// Intervals of an inspection's scores against the truth, from many small lines. Slow.
#include <cmath>

#include <gtest/gtest.h>

#include "metrics/statistics/estimate.h"
#include "studies/evaluation/evaluation.h"
#include "studies/inspection_line/visibility.h"
#include "studies/inspection_line/visibility_trials.h"
#include "tests/studies/inspection_line/visibility_support.h"

namespace glint {
namespace {

/// One dent on each part, of which some are found.
SceneSettings honest_line() {
  SceneSettings scene = small_line(0.02, 0.08);
  scene.defects[0].second.count = 1;
  scene.inspection.trials.parts = 20;
  scene.inspection.trials.flawless = 16;
  return scene;
}

/// Detection rates of lines with so many parts, none of them twice.
std::vector<Scores> lines_of(const std::string& score, int parts, int repeats, std::int64_t first) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = honest_line();
  scene.inspection.trials.parts = parts;
  const std::vector<std::string> names = {score};
  std::vector<Scores> scores;
  for (int k = 0; k < repeats; ++k) {
    scores.push_back(visibility_scores(store, scene, names, first + k * parts));
  }
  return scores;
}

int covered(const std::vector<Scores>& lines, const std::string& score, double truth) {
  int count = 0;
  for (const Scores& scores : lines) {
    count += scores.at(score + ".low") <= truth && truth <= scores.at(score + ".high") ? 1 : 0;
  }
  return count;
}

// 100 lines of 20 parts against one of 400. 95 of 100 are expected; fewer than 88 would come about
// once in 400 times if each covered with 95 %, and the 400 are uncertain by 0.025 themselves.
TEST(VisibilityHonesty, WilsonOfTwentyPartsCoversTheRateOfFourHundred) {
  const std::string score = "inspection.detection_rate";
  const double truth = lines_of(score, 400, 1, 100000).front().at(score);
  EXPECT_GT(truth, 0.2);
  EXPECT_LT(truth, 0.95);
  const std::vector<Scores> lines = lines_of(score, 20, 100, 0);
  EXPECT_GE(covered(lines, score, truth), 88);
  // A control: intervals are not so wide that they cover everything.
  EXPECT_LT(covered(lines, score, truth - 0.4), 15);
}

TEST(VisibilityHonesty, DeLongOfTwentyPartsCoversTheAreaOfFourHundred) {
  const std::string score = "inspection.auc";
  const double truth = lines_of(score, 400, 1, 100000).front().at(score);
  const std::vector<Scores> lines = lines_of(score, 20, 100, 0);
  EXPECT_GE(covered(lines, score, truth), 85);
}

// The median of 20 is a coarse figure; the bootstrap of it is known to be a little too narrow.
TEST(VisibilityHonesty, BootstrapOfTwentyPartsCoversTheMatchedFilterOfFourHundred) {
  const std::string score = "inspection.dprime";
  const double truth = lines_of(score, 400, 1, 100000).front().at(score);
  const std::vector<Scores> lines = lines_of(score, 20, 60, 0);
  EXPECT_GE(covered(lines, score, truth), 48);
}

// A figure of one picture: 95 % intervals of the mean of 8 scans cover the mean of 200.
TEST(VisibilityHonesty, StudentOfEightScansCoversTheMeanOfFourHundred) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = small_line(0.3, 0.5);
  const WantedScores plain = {.fringes = false, .slot = false};
  std::vector<double> values;
  for (int k = 0; k < 400; ++k) {
    scene.sensor.seed = 1000 + k;
    values.push_back(evaluate(store, scene, {}, plain).scores.at("defects.mean_weber"));
  }
  const double truth = mean_of(values).value;
  int count = 0;
  for (std::size_t k = 0; k + 8 <= values.size(); k += 8) {
    const Estimate mean = mean_of(std::span(values).subspan(k, 8));
    count += mean.low <= truth && truth <= mean.high ? 1 : 0;
  }
  EXPECT_GE(count, 43);  // of 50; 47.5 are expected
  scene.sensor.seed = 1000;
  const WantedScores bounds = {.trials = {"defects.mean_weber.low"}};
  const Scores scores = evaluate(store, scene, {}, bounds).scores;
  const Estimate first = mean_of(std::span(values).first(8));
  EXPECT_NEAR(scores.at("defects.mean_weber.low"), first.low, 1e-3 * std::abs(first.low));
}

// A ball cut out of the part is steepest at its rim, 4 h / d: for 0.6 to 1 mm 6.67 to 4 mrad a um.
TEST(VisibilityScores, MeasureTheSmallestSlopeOnTheMesh) {
  SceneSettings scene = small_line(2.0, 2.0);
  DefectGroup& dents = scene.defects[0].second;
  dents = {
      .realisation = Realisation::kImprinted, .diameter_mm = dents.diameter_mm, .roughness = 0};
  scene.inspection.trials.parts = 1;
  ThreadPool pool(2);
  SceneStore store(pool);
  const std::string height = "inspection.smallest_height_um";
  const std::string slope = "inspection.smallest_slope_mrad";
  const Scores scores = visibility_scores(store, scene, std::vector{height, slope}, 0);
  EXPECT_NEAR(scores.at(slope) / scores.at(height), 5.3, 1.4);
}

}  // namespace
}  // namespace glint
