// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validate_run.h"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "tests/studies/validate/trial_cell.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(Validate, AnUndisturbedCellAgreesAndKeepsItsRanking) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {.seed = 5}, {"ring", "dome"});
  const Json result = validate_trial(folder.path());
  EXPECT_EQ(result["agreement"], "agrees") << result["verdict"];
  EXPECT_LT(result["edges"]["mean_distance_px"].get<double>(), 0.3);
  ASSERT_EQ(result["designs"].size(), 2U);
  EXPECT_TRUE(result["ranking"]["agrees"].get<bool>());
  EXPECT_EQ(result["rankings"][0]["objective"], "defects.min_cnr");
  for (const char* file : {"result.json",
                           "report.html",
                           "run.json",
                           "ring/view_01/overlay.png",
                           "ring/view_01/difference.exr"}) {
    EXPECT_TRUE(fs::exists(folder.path() / "out" / file)) << file;
  }
}

// Its grey values are one step of the sensor's 255, their noise a third of one: pixels of one
// brightness are rounded alike.
TEST(Validate, ADesignAsDarkAsOneStepAgrees) {
  const Json dark = validated_dome("0.011", 1.0);
  EXPECT_EQ(dark["agreement"], "agrees") << dark["verdict"] << dark["grey"];
  EXPECT_GT(dark["grey"][0]["rounding_share"].get<double>(), 0.03) << dark["grey"];
  const Json wrong = validated_dome("0.8", 2.0);
  EXPECT_EQ(wrong["agreement"], "does_not_agree") << wrong["verdict"];
  EXPECT_TRUE(has_cause(wrong, "exposure")) << wrong["causes"];
  EXPECT_LT(wrong["grey"][0]["rounding_share"].get<double>(), 0.001) << wrong["grey"];
}

// Rounding is allowed for at the grey values of the design: what a light lacks is none. Other
// powers are tried by the slow tests. One of the pictures has not even noise.
TEST(Validate, ADarkDesignWhoseLightIsDeadDoesNotAgree) {
  const TemporaryFolder folder;
  const auto dead = [](SceneSettings& scene) { scene.sensor.exposure *= 1e-3; };
  make_trial(folder.path(), {.change = dead, .seed = 5}, {"dome"}, 2, dome_study("0.011"));
  write_png(folder.path() / "pictures/dome/views/view_02/sequence/frame_000.png",
            ImageF(204, 170),
            PixelDepth::k8Bit);
  const Json wrong = validate_trial(folder.path());
  EXPECT_EQ(wrong["agreement"], "does_not_agree") << wrong["verdict"] << wrong["grey"];
  EXPECT_TRUE(has_cause(wrong, "exposure")) << wrong["causes"];
  EXPECT_THAT(wrong["pairs"][1]["notes"].dump(), HasSubstr("has one grey value all over"));
}

/// The cause of that name and light.
bool has_cause_of(const Json& result, const std::string& name, const std::string& of) {
  return std::ranges::any_of(result["causes"], [&](const Json& cause) {
    return cause["name"] == name && cause["of"] == of && !cause["within_tolerance"].get<bool>();
  });
}

TEST(Validate, ADeadLightAmongThreeDesignsDoesNotAgree) {
  const TemporaryFolder folder;
  const std::string study =
      "[prototypes.both]\n\"lighting.dome.radiance\" = [0.4]\n" + std::string(kTrialStudy);
  make_trial(folder.path(), {.seed = 5}, {"ring", "both"}, 1, study);
  const auto dead = [](SceneSettings& scene) { scene.sensor.exposure *= 1e-3; };
  make_trial(folder.path(), {.change = dead, .seed = 6}, {"dome"}, 1, study);
  const Json result = validate_trial(folder.path());
  EXPECT_EQ(result["agreement"], "does_not_agree") << result["verdict"] << result["grey"];
  EXPECT_TRUE(has_cause_of(result, "light_power", "dome")) << result["causes"];
}

/// What a validation of ring and dome with a refit leaves, and a person's note.
void leave_earlier_results(const fs::path& out) {
  for (const char* file : {"ring/refit.toml",
                           "ring/view_02/overlay.png",
                           "dome/refit.toml",
                           "dome/view_01/overlay.png",
                           "dome/simulated/views/view_01/image.png",
                           "before/view_01/overlay.png",
                           "ring/note.txt"}) {
    make_folder((out / file).parent_path());
    write_file(out / file, "");
  }
  write_file(out / "run.json", R"({"verb": "validate"})");
  write_file(out / "result.json",
             R"({"before": [{"design": "ring", "view": "view_01"}],
                 "pairs": [{"design": "ring", "view": "view_02"},
                           {"design": "dome", "view": "view_01"}]})");
}

// All of its pictures were rejected: the other one is judged, and nothing in the folder is of
// another validation.
TEST(Validate, LeavesADesignWithoutAnyWholeViewOutByName) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {.seed = 5}, {"ring", "dome"}, 1);
  const fs::path acquired = folder.path() / "pictures/dome/acquired.json";
  Json json = Json::parse(read_file(acquired));
  for (Json& picture : json["pictures"]) {
    picture["accepted"] = false;
  }
  write_file(acquired, json.dump());
  const fs::path out = folder.path() / "out";
  leave_earlier_results(out);
  const Json result = validate_trial(folder.path());
  for (const char* gone : {"dome", "before", "ring/refit.toml", "ring/view_02"}) {
    EXPECT_FALSE(fs::exists(out / gone)) << gone;
  }
  for (const char* there : {"ring/note.txt", "ring/view_01/overlay.png", "ring/simulated/views"}) {
    EXPECT_TRUE(fs::exists(out / there)) << there;
  }
  ASSERT_EQ(result["designs"].size(), 1U);
  EXPECT_EQ(result["designs"][0]["name"], "ring");
  ASSERT_EQ(result["left_out"].size(), 1U);
  EXPECT_EQ(result["left_out"][0]["name"], "dome");
  EXPECT_THAT(result["left_out"][0]["reason"].get<std::string>(),
              HasSubstr("has no accepted picture"));
  EXPECT_THAT(result["notes"].dump(), HasSubstr("dome is left out"));
}

// A tenth of a step: what is recorded are peaks of noise.
TEST(Validate, ADesignOfATenthOfAStepCannotBeJudged) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {.seed = 5}, {"dome"}, 1, dome_study("0.001"));
  const Json result = validate_trial(folder.path());
  EXPECT_EQ(result["causes"], Json::array()) << result["grey"];
  EXPECT_GT(result["grey"][0]["rounding_share"].get<double>(), 0.5) << result["grey"];
  EXPECT_THAT(result["verdict"].get<std::string>(), HasSubstr("dome are too dark to be judged"));
  EXPECT_THAT(result["notes"].dump(), HasSubstr("dome: its grey values cannot be judged"));
  EXPECT_THAT(read_file(folder.path() / "out/report.html"), HasSubstr("cannot be judged"));
}

// A scan's mean has finer steps than the frames that it is the mean of.
TEST(Validate, AMeanOfFramesIsRoundedAsTheyAre) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {.seed = 5}, {"dome"}, 1, dome_study("0.006"));
  const fs::path view = folder.path() / "pictures/dome/views/view_01";
  const ImageF frame = read_image(view / "sequence/frame_000.png");
  ImageF mean = frame;
  for (std::size_t i = 1; i < mean.size(); ++i) {
    mean.values()[i] = 2.0F / 3.0F * frame.values()[i] + frame.values()[i - 1] / 3.0F;
  }
  write_png(view / "aspect.png", mean, PixelDepth::k16Bit);
  const Json result = validate_trial(folder.path());
  EXPECT_EQ(result["agreement"], "agrees") << result["verdict"] << result["grey"];
  EXPECT_GT(result["grey"][0]["rounding_share"].get<double>(), 0.03) << result["grey"];
}

/// A mirror that is no lamp's: closed forms render it.
constexpr const char* kMirrorScene = R"(schema = 2
[part]
shape = "strip"
length_mm = 40
width_mm = 24
radius_along_mm = 400
radius_across_mm = 60
[camera]
width_px = 204
height_px = 170
pixel_um = 41.4
object_pixel_mm = 0.3
working_distance_mm = 180
[sensor]
bits = 8
full_well_e = 10000
read_noise_e = 10
[scan]
positions = 1
[lighting.tunnel]
shape = "semicylinder"
radius_mm = 80
slot_mm = 24
length_mm = 400
period_mm = 40
[calibration.flange_from_camera]
translation_mm = [0, 50, 30]
sigma_mm = [0.04, 0.04, 0.04]
sigma_deg = [0.012, 0.012, 0.012]
[cell.base_from_part]
translation_mm = [280, -120, 20]
sigma_mm = [0.03, 0.03, 0.03]
sigma_deg = [0.02, 0.02, 0.02]
[[viewpoint]]
position_mm = [0, 0, 180]
direction = [0, 0, -1]
up = [0, 1, 0]
[prototypes.tunnel]
"lighting.tunnel.period_mm" = 40
)";

Json validated_mirror(double power) {
  const TemporaryFolder folder;
  const auto change = [power](SceneSettings& scene) { scene.sensor.exposure *= power; };
  make_trial(folder.path(), {.change = change, .seed = 5}, {"tunnel"}, 1, "", kMirrorScene);
  return validate_trial(folder.path());
}

TEST(Validate, AMirrorUnderATunnelAtHalfTheExposureDoesNotAgree) {
  const Json same = validated_mirror(1.0);
  EXPECT_EQ(same["agreement"], "agrees") << same["verdict"] << same["grey"];
  ASSERT_EQ(same["grey"].size(), 1U);
  EXPECT_NEAR(same["grey"][0]["values"][0]["value"].get<double>(), 1.0, 0.01) << same["grey"];
  EXPECT_TRUE(same["grey"][0]["after_share"].is_null());
  EXPECT_THAT(same["notes"].dump(), HasSubstr("tunnel: its light is not path traced"));
  const Json half = validated_mirror(0.5);
  EXPECT_EQ(half["agreement"], "does_not_agree") << half["verdict"] << half["grey"];
  EXPECT_TRUE(has_cause(half, "exposure")) << half["causes"];
  EXPECT_NEAR(half["grey"][0]["values"][0]["value"].get<double>(), 0.5, 0.01) << half["grey"];
}

TEST(Validate, APartTurnedByThreeDegreesIsTheCause) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {.part_turn_deg = {0, 0, 3}});
  const Json result = validate_trial(folder.path());
  EXPECT_EQ(result["agreement"], "does_not_agree") << result["verdict"];
  EXPECT_TRUE(has_cause(result, "part_pose")) << result["causes"];
}

// Nobody sees the size of a light in its picture.
TEST(Validate, TellsWhyDesignsAreNotRanked) {
  const TemporaryFolder folder;
  const std::string study = std::string(kTrialStudy);
  const std::string prototypes = study.substr(0, study.find("[objective]"));
  make_trial(folder.path(),
             {.seed = 5},
             {"ring", "dome"},
             1,
             prototypes +
                 "[variables]\n\"lighting.ring.radiance.0\" = { min = 0.1, max = 4 }\n"
                 "[[objective]]\nmaximise = \"defects.min_cnr\"\n"
                 "[[objective]]\nminimise = \"lighting.area_mm2\"\n");
  const fs::path run = folder.path() / "run";
  make_folder(run / "front/trial_003");
  write_file(run / "front/trial_003/scene.toml", read_file(run / "ring/scene.toml"));
  fs::create_directories(folder.path() / "pictures/front");
  fs::copy(folder.path() / "pictures/ring",
           folder.path() / "pictures/front/trial_003",
           fs::copy_options::recursive);
  const Json result = validate_run({.run = run,
                                    .pictures = folder.path() / "pictures",
                                    .out = folder.path() / "out",
                                    .designs = "front/trial_003,dome",
                                    .is_refitting = true,
                                    .threads = 2,
                                    .progress = Progress::Style::kNone});
  ASSERT_EQ(result["rankings"].size(), 2U) << result["rankings"];
  EXPECT_EQ(result["rankings"][0]["ranking"]["simulated"].size(), 2U);
  EXPECT_TRUE(result["rankings"][1]["ranking"].is_null());
  EXPECT_THAT(result["notes"].dump(),
              HasSubstr("not ranked by lighting.area_mm2: none of 2 designs have this score"));
  EXPECT_THAT(result["notes"].dump(),
              HasSubstr("the order by defects.min_cnr holds as far as it can be decided (dome, "
                        "ring, front/trial_003), by lighting.area_mm2 holds"));
  EXPECT_THAT(result["verdict"].get<std::string>(), HasSubstr("by defects.min_cnr"));
  EXPECT_TRUE(fs::exists(folder.path() / "out/front/trial_003/view_01/overlay.png"));
}

TEST(Validate, RefusesWhatCannotBeValidated) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {}, {"ring"}, 1);
  const auto error_of =
      [&](const fs::path& run, const fs::path& pictures, const std::string& designs) {
        try {
          validate_run({.run = run,
                        .pictures = pictures,
                        .out = folder.path() / "out",
                        .designs = designs,
                        .progress = Progress::Style::kNone});
        } catch (const Error& error) {
          return std::string(error.what());
        }
        return std::string();
      };
  const fs::path run = folder.path() / "run";
  const fs::path pictures = folder.path() / "pictures";
  EXPECT_THAT(error_of(folder.path() / "none", pictures, ""), HasSubstr("there is no such folder"));
  EXPECT_THAT(error_of(pictures, pictures, ""), HasSubstr("holds no design"));
  EXPECT_THAT(error_of(run, folder.path() / "none", ""), HasSubstr("there is no such folder"));
  EXPECT_THAT(error_of(run, run / "ring", ""), HasSubstr("holds no pictures of any design"));
  EXPECT_THAT(error_of(run, pictures, "sphere"), HasSubstr("there is no design sphere"));
  EXPECT_THAT(error_of(run, pictures, "dome"), HasSubstr("the design has no pictures"));
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

}  // namespace
}  // namespace glint
