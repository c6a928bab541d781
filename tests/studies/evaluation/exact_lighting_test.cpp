// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/exact_lighting.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/thread_pool.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/evaluation/evaluation.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

constexpr const char* kStudy = R"([lighting.tunnel]
shape = "superellipse"
[cost]
exposure_ms = 8
move_ms = 60
per_mm2 = 0.0004
per_frame = 0.02
[variables]
"lighting.tunnel.half_width_mm" = { min = 40, max = 250 }
"lighting.tunnel.height_mm" = { min = 60, max = 250 }
"lighting.tunnel.slot_mm" = { min = 20, max = 60 }
"scan.positions" = { min = 8, max = 24 }
[[objective]]
maximise = "homogeneity.h_rms"
[[objective]]
minimise = "lighting.width_mm"
[[objective]]
minimise = "cost.total"
[constraints]
"scan.time_s" = { max = 1 }
"lighting.height_mm" = { min = 80 }
"homogeneity.clipped_share" = { max = 0.01 }
)";

TEST(ExactLighting, TellsWhatAnEvaluationGivesBitForBit) {
  const TemporaryFolder folder;
  write_file(folder / "s.toml", kStudy);
  const Study study = load_study(folder / "s.toml", {});
  const ExactScores exact = exact_lighting(study);
  EXPECT_THAT(
      exact.names,
      testing::ElementsAre("lighting.width_mm", "cost.total", "scan.time_s", "lighting.height_mm"));
  ThreadPool pool(1);
  SceneStore store(pool);
  WantedScores wanted = {.lighting = true, .picture = false};
  const Sobol sobol(1, 4);
  for (std::uint32_t i = 0; i < 20; ++i) {
    const Point point = point_from_unit(study.space, sobol.point(i));
    const Scores told = exact.at(point);
    const Scores evaluated =
        evaluate(store, scene_with(study, overrides_of(study, point)), {}, wanted).scores;
    for (const std::string& name : exact.names) {
      EXPECT_EQ(told.at(name), evaluated.at(name)) << name;
    }
    EXPECT_NEAR(told.at("lighting.width_mm"), 2.0 * point[0], 1e-6 * point[0]);
  }
}

TEST(ExactLighting, OfAGoalOfPicturesThereIsNone) {
  const TemporaryFolder folder;
  write_file(folder / "s.toml",
             "[variables]\n\"lighting.tunnel.slot_mm\" = { min = 20, max = 60 }\n"
             "[objective]\nmaximise = \"homogeneity.h_rms\"\n");
  const Study study = load_study(folder / "s.toml", {});
  EXPECT_TRUE(exact_lighting(study).names.empty());
}

}  // namespace
}  // namespace glint
