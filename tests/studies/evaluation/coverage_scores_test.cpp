// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the views of a scene inspect, as a score of a study.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"
#include "tests/studies/evaluation/covered_plate.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::Not;
using ::testing::ThrowsMessage;

class CoverageScores : public ::testing::Test {
 protected:
  Study study(const std::string& goal) {
    write_file(folder_ / "study.toml", std::string(test::kCoveredPlate) + goal);
    return load_study(folder_ / "study.toml", {});
  }

  TemporaryFolder folder_;
  ThreadPool pool_{2};
  SceneStore store_{pool_};
};

TEST_F(CoverageScores, AreAllThatAGoalOfThemAloneNeeds) {
  const Study of_coverage = study("[objective]\nmaximise = \"coverage.c1\"\n");
  const Scores scores = evaluate(store_, of_coverage.scene, {}, wanted_by(of_coverage.goal)).scores;
  EXPECT_NEAR(scores.at("coverage.c1"), 2400.0 / 5200.0, 1e-9);
  EXPECT_EQ(scores.at("coverage.c2"), 0.0);
  EXPECT_NEAR(scores.at("coverage.redundancy"), 2400.0 / 5200.0, 1e-9);
  EXPECT_NEAR(scores.at("coverage.largest_gap_mm2"), 2800.0, 1e-6);
  EXPECT_EQ(scores.size(), 4U);
  EXPECT_EQ(store_.num_rendered(), 0);
}

TEST_F(CoverageScores, StandBesideThoseOfThePicture) {
  const Study both = study(
      "[objective]\nmaximise = \"homogeneity.h_rms\"\n[constraints]\n"
      "\"coverage.c1\" = { min = 0.4 }\n");
  const Scores scores = evaluate(store_, both.scene, {}, wanted_by(both.goal)).scores;
  EXPECT_THAT(scores, Contains(Key("homogeneity.h_rms")));
  EXPECT_THAT(scores, Contains(Key("coverage.c1")));
  const Study without = study("[objective]\nmaximise = \"homogeneity.h_rms\"\n");
  EXPECT_THAT(evaluate(store_, without.scene, {}, wanted_by(without.goal)).scores,
              Not(Contains(Key("coverage.c1"))));
}

// At 100 mm the picture is 80 / 3 x 60 / 3 mm at the origin, 99 % of that on the plate's top.
TEST_F(CoverageScores, FollowTheVariables) {
  const Study moved = study("[objective]\nmaximise = \"coverage.c1\"\n");
  const SceneSettings near = scene_with(moved, overrides_of(moved, {100.0}));
  const double seen_mm2 = 0.99 * 0.99 * 80.0 / 3.0 * 20.0;
  EXPECT_NEAR(evaluate(store_, near, {}, wanted_by(moved.goal)).scores.at("coverage.c1"),
              seen_mm2 / 5200.0,
              0.002);
}

TEST_F(CoverageScores, OfAnotherNameAreRefused) {
  EXPECT_THAT([&] { study("[objective]\nmaximise = \"coverage.c3\"\n"); },
              ThrowsMessage<ConfigError>(HasSubstr("coverage.c")));
}

}  // namespace
}  // namespace glint
