// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures that are validated are those of the design's own lights.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/config.h"
#include "core/error.h"
#include "core/file.h"
#include "core/thread_pool.h"
#include "studies/definition/study.h"
#include "studies/validate/validated_designs.h"
#include "tests/studies/validate/trial_cell.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// A run with the winner only, and the folder of its pictures, none of which was accepted: that
/// is what is complained of where its lights are right.
class PicturesOfAWinner : public testing::Test {
 protected:
  PicturesOfAWinner() {
    make_folder(folder_ / "run/winner");
    make_folder(folder_ / "pictures/winner");
    write_file(folder_ / "run/study.resolved.toml", kTrialScene);
    write_file(folder_ / "run/winner/scene.toml", kTrialScene);
    write_file(folder_ / "pictures/winner/acquired.json",
               R"({"schema": 1, "kind": "acquired", "status": "complete", "calibration": null,
                   "twin": false, "pictures": []})");
  }

  /// As `glint acquire` leaves the scene that it took pictures of. @param edit  of the winner's
  void take_with(const std::string& edit, const std::string& by = "") const {
    std::string text = kTrialScene;
    text.replace(text.find(edit), edit.size(), by);
    write_file(folder_ / "taken.toml", text);
    write_file(folder_ / "pictures/winner/scene.toml",
               to_toml(write_scene(load_study(folder_ / "taken.toml", {}).scene)));
  }

  std::string error() const {
    try {
      validate_trial(folder_.path());
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
};

TEST_F(PicturesOfAWinner, AreTakenWhereItsLightsAreTheSame) {
  EXPECT_THAT(error(), HasSubstr("has no accepted picture")) << "taken elsewhere, without a scene";
  take_with("x_mm = [-10]", "x_mm = [-11]");
  EXPECT_THAT(error(), HasSubstr("has no accepted picture")) << "a dent is no light";
}

TEST_F(PicturesOfAWinner, AreRefusedWhereAnEarlierOneHadOtherLights) {
  take_with("outer_radius_mm = 56", "outer_radius_mm = 57");
  EXPECT_THAT(error(),
              AllOf(HasSubstr("pictures/winner: holds pictures of another prototype"),
                    HasSubstr("[lighting.ring] is built differently"),
                    HasSubstr("run/winner/scene.toml")));
  take_with("radiance = [2.2]", "radiance = [2.3]");
  EXPECT_THAT(error(), HasSubstr("[lighting.ring] shines at another power"));
  fs::remove(folder_ / "pictures/winner/acquired.json");
  EXPECT_THAT(error(), testing::Not(HasSubstr("holds pictures of")))
      << "a scene that somebody put there";
}

// What a cell that is not calibrated yet names is where the drawing has the camera.
TEST(PicturesOfACell, AreCalibratedByAFileThatTellsTheCamera) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {}, {"ring"}, 1);
  const fs::path acquired = folder / "pictures/ring/acquired.json";
  auto json = nlohmann::ordered_json::parse(read_file(acquired));
  json["calibration"] = "calibration.toml";
  write_file(acquired, json.dump());
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto is_calibrated = [&](const std::string& calibration) {
    write_file(folder / "pictures/ring/calibration.toml", calibration);
    return find_validated(folder / "run", folder / "pictures", "ring", {}, store).is_calibrated;
  };
  const std::string drawing = "[calibration.flange_from_camera]\ntranslation_mm = [0, 50, 30]\n";
  EXPECT_FALSE(is_calibrated(drawing));
  EXPECT_TRUE(is_calibrated(drawing + "[camera]\nwidth_px = 204\nheight_px = 170\npixel_um = 41.4\n"
                                      "object_pixel_mm = 0.3\nworking_distance_mm = 180\n"));
}

}  // namespace
}  // namespace glint
