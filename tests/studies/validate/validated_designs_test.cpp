// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures that are validated are those of the design's own lights.
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/config.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/thread_pool.h"
#include "studies/definition/scene_file.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_picture.h"
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

/// A run with a ring that sensor.expose_to exposes, rendered coarsely, and a picture that is not
/// looked at.
class DesignOfEqualExposure : public testing::Test {
 protected:
  DesignOfEqualExposure() {
    std::string scene = kTrialScene;
    replace(scene, "[sensor]\n", "[sensor]\nexpose_to = 0.5\n");
    replace(scene, "samples = 16", "samples = 2");
    make_trial(folder_.path(), {}, {}, 0, kTrialStudy, scene);
    make_folder(folder_ / "pictures/ring/view_01");
    write_png(folder_ / "pictures/ring/view_01/image.png", ImageF(204, 170), PixelDepth::k8Bit);
  }

  static void replace(std::string& text, const std::string& part, const std::string& by) {
    const std::size_t at = text.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    text.replace(at, part.size(), by);
  }

  ValidatedDesign found(std::vector<std::string>& notes) {
    ValidationSources sources =
        find_validated(folder_ / "run", folder_ / "pictures", "ring", {}, store_);
    notes = sources.notes;
    return sources.designs.at(0);
  }

  TemporaryFolder folder_;
  ThreadPool pool_{1};
  SceneStore store_{pool_};
};

TEST_F(DesignOfEqualExposure, IsComparedAtTheExposureThatACellTakesItAt) {
  fs::rename(folder_ / "pictures/ring/view_01/image.png", folder_ / "pictures/ring/view_01.png");
  fs::remove(folder_ / "pictures/ring/view_01");
  const SceneSettings written = load_scene(folder_ / "run/ring/scene.toml");
  const double exposure = with_equal_exposure(store_, written).sensor.exposure;
  EXPECT_GT(std::abs(exposure - 1.0), 0.1);
  std::vector<std::string> notes;
  const ValidatedDesign design = found(notes);
  EXPECT_DOUBLE_EQ(design.nominal.sensor.exposure, exposure);
  EXPECT_DOUBLE_EQ(design.scene.sensor.exposure, exposure);
  EXPECT_EQ(design.scene.expose_to, 0.0);
}

// `glint render` shows views at sensor.exposure.
TEST_F(DesignOfEqualExposure, IsComparedAtItsOwnExposureWithRenderedViews) {
  fs::copy(folder_ / "run/ring/scene.toml", folder_ / "pictures/ring/view_01/scene.toml");
  std::vector<std::string> notes;
  const ValidatedDesign design = found(notes);
  EXPECT_EQ(design.scene.sensor.exposure, 1.0);
  EXPECT_EQ(design.scene.expose_to, 0.0);
}

TEST_F(DesignOfEqualExposure, HasItsOwnExposureWithANoteWhereNothingShines) {
  const fs::path scene = folder_ / "run/ring/scene.toml";
  std::string dark = read_file(scene);
  replace(dark, "radiance = [2.2", "radiance = [0.0");
  write_file(scene, dark);
  fs::rename(folder_ / "pictures/ring/view_01/image.png", folder_ / "pictures/ring/view_01.png");
  fs::remove(folder_ / "pictures/ring/view_01");
  std::vector<std::string> notes;
  EXPECT_EQ(found(notes).scene.sensor.exposure, 1.0);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(notes[0], HasSubstr("ring: compared at its sensor.exposure: "));
}

}  // namespace
}  // namespace glint
