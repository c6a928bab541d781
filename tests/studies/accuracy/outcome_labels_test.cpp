// SPDX-License-Identifier: GPL-3.0-or-later
//
// Under which rung, replicate and seed outcomes are kept.
#include "studies/accuracy/outcome_labels.h"

#include <gtest/gtest.h>

#include "studies/definition/render_methods.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

// It follows no paths: the sensor's noise alone is another one.
TEST(OutcomeLabels, TellReplicatesOfAMirrorApart) {
  SceneSettings mirror;
  mirror.paths.seed = 5;
  mirror.sensor.seed = 11;
  ASSERT_EQ(repeated_settings(mirror, 3).paths.seed, 5);
  const OutcomeLabel repeated = repeated_label(mirror, 3);
  EXPECT_EQ(repeated.rung, "[render]");
  EXPECT_EQ(repeated.replicate, 4);
  EXPECT_EQ(repeated.seed, 2003008U);
  const OutcomeLabel rescored = rescored_label(mirror);
  EXPECT_EQ(rescored.rung, "[render], re-scored");
  EXPECT_EQ(rescored.replicate, 1);
  EXPECT_EQ(rescored.seed, 1000008U);
}

TEST(FreshOutcomes, AreKeptOfTrialsAndReplaced) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "study.sqlite", {.config_hash = "abc"});
  FreshOutcomes fresh(storage);
  const OutcomeLabel label = rescored_label(SceneSettings());
  fresh.keep(label, 0, {.scores = {{"h", 0.1}}});  // a prototype
  fresh.keep(label, 3, {.scores = {{"h", 0.2}}});
  fresh.keep(label, 3, {.scores = {{"h", 0.3}}});
  const std::vector<Replicate> kept = storage.replicates(TrialKind::kSearch);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].number, 3);
  EXPECT_EQ(kept[0].rung, label.rung);
  EXPECT_EQ(kept[0].outcome.scores.at("h"), 0.3);
}

}  // namespace
}  // namespace glint
