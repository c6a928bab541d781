// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/reach/reach_scores.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"
#include "tests/studies/cell/ur3_cells.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

const std::string kArm = std::string(test::kUr3WithCamera) + R"([[safe_position]]
joints_deg = [8.873, -82.466, -92.57, -94.964, 90.0, -81.127]
)";

// Of its two views one is 900 mm away.
const std::string kReachedStudy = R"(schema = 2
[part]
shape = "plate"
length_mm = 48
width_mm = 36
thickness_mm = 5
[lighting.ring]
mount = "camera"
inner_radius_mm = 30
outer_radius_mm = 60
height_mm = 60
[calibration]
setup = "eye_in_hand"
[calibration.flange_from_camera]
translation_mm = [0, 50, 30]
[cell]
file = "cell.toml"
[cell.base_from_part]
translation_mm = [280, -120, 20]
[[viewpoint]]
position_mm = [0, 0, 180]
direction = [0, 0, -1]
[[viewpoint]]
position_mm = [900, 0, 180]
direction = [0, 0, -1]
[objective]
maximise = "reach.share"
[variables]
"lighting.ring.height_mm" = { min = 20, max = 170 }
)";

class ReachScoresTest : public testing::Test {
 protected:
  ReachScoresTest() { write_file(folder_ / "cell.toml", kArm); }

  Study study(const std::string& text) {
    write_file(folder_ / "study.toml", text);
    return load_study(folder_ / "study.toml", {});
  }

  TemporaryFolder folder_;
  ThreadPool pool_{1};
  SceneStore store_{pool_};
};

TEST_F(ReachScoresTest, AreThoseOfThePlan) {
  const Study reached = study(kReachedStudy);
  const Scores scores = reach_scores(store_, reached.scene);
  EXPECT_EQ(scores.at("reach.share"), 0.5);
  EXPECT_GT(scores.at("reach.margin_mm"), 5.0);
}

// A disc 182 mm before the camera, which stands 180 mm from the part: it cuts through the plate.
TEST_F(ReachScoresTest, FallWhenALightIsInTheWay) {
  Study reached = study(kReachedStudy);
  std::get<RingSettings>(reached.scene.lights[0].settings).height_mm = 182.0;
  std::get<RingSettings>(reached.scene.lights[0].settings).inner_radius_mm = 5.0;
  EXPECT_EQ(reach_scores(store_, reached.scene).at("reach.share"), 0.0);
  EXPECT_EQ(reach_scores(store_, reached.scene).at("reach.margin_mm"), 0.0);
}

TEST_F(ReachScoresTest, ServeAsObjectiveWithoutAPicture) {
  const Study reached = study(kReachedStudy);
  const WantedScores wanted = wanted_by(reached.goal);
  EXPECT_TRUE(wanted.reach);
  EXPECT_FALSE(wanted.picture);
  const Evaluation evaluation = evaluate(store_, reached.scene, {}, wanted);
  EXPECT_EQ(evaluation.scores.at("reach.share"), 0.5);
  EXPECT_EQ(store_.num_rendered(), 0);
}

TEST_F(ReachScoresTest, NeedTheFileOfACell) {
  std::string text = kReachedStudy;
  text.erase(text.find("file = \"cell.toml\"\n"), 19);
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { study(text); }),
              testing::HasSubstr("needs the cell file of an arm"));
}

}  // namespace
}  // namespace glint
