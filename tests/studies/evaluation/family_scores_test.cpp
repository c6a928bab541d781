// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scores of the homogeneity family and of single frames, as a study asks for them.
#include <gtest/gtest.h>

#include "studies/evaluation/evaluation.h"
#include "tests/studies/inspection_line/visibility_support.h"

namespace glint {
namespace {

Scores scores_of(const SceneSettings& scene, const WantedScores& wanted) {
  ThreadPool pool(2);
  SceneStore store(pool);
  return evaluate(store, scene, {}, wanted).scores;
}

TEST(Evaluate, TakesTheHomogeneityFamilyOnlyWhereItIsAskedFor) {
  const SceneSettings scene = small_line(0.5, 1.0);
  EXPECT_FALSE(scores_of(scene, {}).contains("homogeneity.residual"));
  const Scores scores = scores_of(scene, {.family = true});
  EXPECT_DOUBLE_EQ(scores.at("homogeneity.low_share") + scores.at("homogeneity.high_share"), 1.0);
  EXPECT_GT(scores.at("homogeneity.residual"), scores.at("homogeneity.h_rms"));
  EXPECT_LT(scores.at("homogeneity.residual"), 1.0);
  EXPECT_GT(scores.at("homogeneity.u0"), 0.0);
  EXPECT_LT(scores.at("homogeneity.u0"), 1.0);
}

TEST(Evaluate, FindsTheRippleOfADutyThatTheScanDoesNotCancel) {
  SceneSettings scene = small_line(0.5, 1.0);
  scene.sensor.full_well_e = 0.0;
  scene.sensor.read_noise_e = 0.0;
  scene.sensor.gain = 1.0;
  scene.scan.positions = 4;
  scene.tunnel.period_mm = 8.0;  // 25 px
  const auto ripple = [&](double duty) {
    scene.tunnel.duty = duty;
    return scores_of(scene, {.family = true}).at("homogeneity.ripple");
  };
  EXPECT_GT(ripple(0.4), 0.1);    // 4 x 0.4 = 1.6
  EXPECT_LT(ripple(0.5), 0.001);  // 4 x 0.5 = 2
}

TEST(Evaluate, HasBoundsOfTheFamily) {
  SceneSettings scene = small_line(0.5, 1.0);
  scene.tunnel.period_mm = 8.0;
  scene.tunnel.duty = 0.4;
  scene.scan.positions = 4;
  const WantedScores wanted = {.family = true,
                               .trials = {"homogeneity.residual.low", "homogeneity.ripple.high"}};
  const Scores scores = scores_of(scene, wanted);
  EXPECT_LT(scores.at("homogeneity.residual.low"), scores.at("homogeneity.residual.high"));
  EXPECT_LT(scores.at("homogeneity.ripple.low"), scores.at("homogeneity.ripple.high"));
}

TEST(Evaluate, TakesPercentilesOnlyWhereTheyAreAskedFor) {
  const SceneSettings scene = small_line(0.5, 1.0);
  EXPECT_FALSE(scores_of(scene, {.robust = false}).contains("homogeneity.robust"));
  const Scores scores = scores_of(scene, {.trials = {"homogeneity.robust.low"}});
  EXPECT_LT(scores.at("homogeneity.robust.low"), scores.at("homogeneity.robust.high"));
  EXPECT_FALSE(wanted_by({.objective = {.name = "homogeneity.h_rms"}}).robust);
  EXPECT_TRUE(wanted_by({.objective = {.name = "homogeneity.robust.low"}}).robust);
}

TEST(WantedBy, AsksForTheFamilyAndForStripesWhereTheRippleNeedsThem) {
  const Goal residual = {.objective = {.name = "homogeneity.residual"}};
  EXPECT_TRUE(wanted_by(residual).family);
  EXPECT_FALSE(wanted_by(residual).fringes);
  const Goal ripple = {.objective = {.name = "homogeneity.h_rms"},
                       .constraints = {{.name = "homogeneity.ripple", .max = 0.1}}};
  EXPECT_TRUE(wanted_by(ripple).family);
  EXPECT_TRUE(wanted_by(ripple).fringes);
  EXPECT_FALSE(wanted_by({.objective = {.name = "homogeneity.h_rms"}}).family);
}

// The noise of 24 frames is no change: dents of a thousandth of a nanometre unite to nothing.
TEST(Evaluate, UnitesNothingWhereThereIsOnlyNoise) {
  EXPECT_EQ(scores_of(small_line(1e-6, 2e-6), {}).at("defects.dent_1.union"), 0.0);
  const Scores deep = scores_of(small_line(2.0, 3.0), {});
  EXPECT_GT(deep.at("defects.min_union"), 0.3);
  EXPECT_LT(deep.at("defects.dent_1.union"), 1.5);
}

}  // namespace
}  // namespace glint
