// SPDX-License-Identifier: GPL-3.0-or-later
//
// The choice of a rung where the designs of a search are rough, by paths, or mirrors, and its
// prototypes are the others, with evaluations that are made up.
#include <atomic>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/accuracy/accuracy_report.h"
#include "studies/accuracy/chosen_accuracy.h"
#include "tests/studies/plate_under_two_lights.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

const std::string kMixedStudy = std::string(test::kPlateUnderTwoLights) + R"([variables]
lighting_use = { choices = ["tunnel", "ring"] }
"sensor.gain" = { min = 0.5, max = 2 }
[objective]
maximise = "homogeneity.mean"
[budget]
evaluations = 0
wall_clock = "1h"
[accuracy]
tolerance = { "homogeneity.mean" = 0.2 }
)";

/// The study with one kind of light, and a prototype of the other one.
std::string with_prototype(const std::string& searched, const std::string& prototype) {
  std::string text = kMixedStudy;
  const std::string kinds = "lighting_use = { choices = [\"tunnel\", \"ring\"] }\n";
  text.erase(text.find(kinds), kinds.size());
  text.insert(text.find("[part]"), "lighting_use = \"" + searched + "\"\n");
  return text + "[prototypes.other]\nlighting_use = \"" + prototype + "\"\n";
}

// A mirror is rendered the same by every number of samples. If it counted, its errors of 0 would
// make those of the others look smaller than they are.
TEST(ChooseAccuracy, ComparesNoDesignsThatAllRungsRenderAlike) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", with_prototype("ring", "tunnel"));
  const Study study = load_study(folder / "study.toml", {});
  ThreadPool pool(1);
  SceneStore store(pool);
  std::atomic<int> mirrors = 0;
  std::atomic<int> rough = 0;
  const ChosenAccuracy chosen = choose_accuracy(
      {.study = study,
       .store = store,
       .evaluate = [&](const Overrides& overrides, const RenderRung&) {
         ++(needs_paths(scene_with(study, overrides)) ? rough : mirrors);
         return Outcome{.scores = {{"homogeneity.mean", 0.5}, {"homogeneity.clipped_share", 0.0}}};
       }});
  EXPECT_EQ(chosen.choice.designs.size(), 12U);
  EXPECT_EQ(chosen.choice.num_failed, 0U);
  EXPECT_EQ(chosen.choice.num_alike, 1U);
  EXPECT_GT(rough, 12);
  EXPECT_EQ(mirrors, 0);
  const auto told = accuracy_json(study, chosen, 0, {});
  EXPECT_EQ(told["alike"], chosen.choice.num_alike);
  const std::string sentence = told["sentence"].get<std::string>();
  EXPECT_THAT(sentence, HasSubstr("how exact their scores are was not compared"));
  EXPECT_THAT(sentence, HasSubstr("as much counted work as")) << "of a search without a length";
}

// One rough prototype makes a ladder of paths. The mirrors that are searched did not fail.
TEST(ChooseAccuracy, ARoughPrototypeBesideMirrorsIsTooFewToCompare) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", with_prototype("tunnel", "ring"));
  const Study study = load_study(folder / "study.toml", {});
  ThreadPool pool(1);
  SceneStore store(pool);
  std::atomic<int> evaluations = 0;
  const ChosenAccuracy chosen = choose_accuracy(
      {.study = study, .store = store, .evaluate = [&](const Overrides&, const RenderRung&) {
         ++evaluations;
         return Outcome{.scores = {{"homogeneity.mean", 0.5}, {"homogeneity.clipped_share", 0.0}}};
       }});
  EXPECT_EQ(evaluations, 1);
  EXPECT_EQ(chosen.choice.num_failed, 0U);
  EXPECT_EQ(chosen.choice.num_alike, 47U);
  EXPECT_EQ(chosen.choice.work, chosen.ladder.back().work) << "of the one that was evaluated";
  EXPECT_THAT(chosen.choice.problem, HasSubstr("1 of 1 designs can be evaluated"));
  EXPECT_THAT(chosen.choice.problem, HasSubstr("the other 47 are mirrors"));
}

// Mirrors under the tunnel by the file's accuracy of directions, rings by one sample.
TEST(CheckAccuracyChoice, RefusesKeysByHandThatLeaveNoBranchAChoice) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", kMixedStudy);
  const std::vector<KeyValue> sets = {{"render.max_direction_error_mrad", "0.2"},
                                      {"render.paths.samples", "1"}};
  const auto refusal = [&](const std::vector<KeyValue>& given) {
    try {
      check_accuracy_choice(load_study(folder / "study.toml", given), false);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal(sets), HasSubstr("leaves one way to render"));
  EXPECT_THAT(refusal(sets), HasSubstr("render.max_direction_error_mrad"));
  EXPECT_EQ(refusal({sets.front()}), "") << "rings have a choice left";
}

}  // namespace
}  // namespace glint
