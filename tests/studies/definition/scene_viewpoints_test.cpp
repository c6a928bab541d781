// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene_viewpoints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "studies/definition/study.h"
#include "studies/definition/study_text.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pointwise;

constexpr double kFlangeTolerance = 1e-9;

/// The flange 700 mm above the base's plane, looking down.
constexpr const char* kView = R"([[viewpoint]]
[viewpoint.base_from_flange]
translation_mm = [400, 50, 700]
rotation_vector_deg = [180, 0, 0]
)";
constexpr const char* kCameraOnFlange =
    "[calibration.flange_from_camera]\ntranslation_mm = [0, 60, 20]\n";
constexpr const char* kInCell = "[cell.base_from_part]\ntranslation_mm = [400, 0, 100]\n";
constexpr const char* kBeside =
    "[calibration.base_from_camera]\ntranslation_mm = [500, 0, 1000]\n"
    "rotation_vector_deg = [180, 0, 0]\n";
constexpr const char* kOnPart = "[cell.flange_from_part]\ntranslation_mm = [0, 0, 50]\n";

struct ReadScene {
  SceneSettings scene;
  std::vector<Problem> errors;

  const Viewpoint& view() const { return scene.viewpoint(); }

  std::string first() const { return errors.empty() ? "" : errors.front().message(); }
};

ReadScene read_text(const std::string& text) {
  ReadScene read;
  read.scene = read_scene(parse_toml(text, "scene.toml"), read.errors);
  return read;
}

std::string in_hand() {
  return std::string(kView) + kCameraOnFlange + kInCell;
}

std::string to_hand() {
  return std::string(
             "[[viewpoint]]\n[viewpoint.base_from_flange]\ntranslation_mm = [500, 0, 400]\n"
             "rotation_vector_deg = [0, 0, 90]\n") +
         kBeside + kOnPart;
}

// base_from_flange turns by 180 degrees about x: the camera's (0, 60, 20) on the flange is
// (0, -60, -20) + (400, 50, 700) = (400, -10, 680) in the base and (0, -10, 580) on the part. It
// looks along -z; its y axis is the base's -y, so +y is up in the picture.
TEST(BaseFromFlange, PlacesACameraOnTheFlange) {
  const ReadScene read = read_text(in_hand());
  ASSERT_EQ(read.first(), "");
  EXPECT_THAT(read.view().position_mm,
              Pointwise(DoubleNear(kFlangeTolerance), std::vector{0.0, -10.0, 580.0}));
  EXPECT_THAT(read.view().direction,
              Pointwise(DoubleNear(kFlangeTolerance), std::vector{0.0, 0.0, -1.0}));
  EXPECT_THAT(read.view().up, Pointwise(DoubleNear(kFlangeTolerance), std::vector{0.0, 1.0, 0.0}));
}

// The robot holds the part at (500, 0, 450), turned by 90 degrees about z, 550 mm below the camera,
// whose picture has the base's +y at the top: the part's +x.
TEST(BaseFromFlange, MovesThePartBeforeACameraBesideTheRobot) {
  const ReadScene read = read_text(to_hand());
  ASSERT_EQ(read.first(), "");
  EXPECT_THAT(read.view().position_mm,
              Pointwise(DoubleNear(kFlangeTolerance), std::vector{0.0, 0.0, 550.0}));
  EXPECT_THAT(read.view().direction,
              Pointwise(DoubleNear(kFlangeTolerance), std::vector{0.0, 0.0, -1.0}));
  EXPECT_THAT(read.view().up, Pointwise(DoubleNear(kFlangeTolerance), std::vector{1.0, 0.0, 0.0}));
}

// A quarter turn about z and 10 mm along x: (0, -10, 580) -> (10, 0, 580) -> (20, 0, 580).
TEST(BaseFromFlange, FollowsAPartThatTheSceneMoves) {
  const ReadScene read =
      read_text(in_hand() + "[part]\nposition_mm = [10, 0, 0]\nrotation_deg = [0, 0, 90]\n");
  ASSERT_EQ(read.first(), "");
  EXPECT_THAT(read.view().position_mm,
              Pointwise(DoubleNear(kFlangeTolerance), std::vector{20.0, 0.0, 580.0}));
  EXPECT_THAT(read.view().up, Pointwise(DoubleNear(kFlangeTolerance), std::vector{-1.0, 0.0, 0.0}));
}

// camera_from_part of the chain against that of the viewpoint, which goes over three vectors.
TEST(BaseFromFlange, GivesTheCameraTheWholePose) {
  const std::string turned =
      "[[viewpoint]]\n[viewpoint.base_from_flange]\ntranslation_mm = [400, 50, 700]\n"
      "rotation_vector_deg = [150, 40, -30]\n";
  const ReadScene read =
      read_text(turned + kCameraOnFlange + "rotation_vector_deg = [5, -7, 88]\n" + kInCell +
                "rotation_vector_deg = [1, 2, 30]\n");
  ASSERT_EQ(read.first(), "");
  const auto pose = [](std::vector<double> at, double x, double y, double z) {
    PoseSettings settings = {.translation_mm = std::move(at)};
    const double rad = 3.14159265358979323846 / 180.0;
    settings.rotation_vector_rad = {x * rad, y * rad, z * rad};
    return transform_of(settings);
  };
  const RigidTransform part_from_camera = inverse(pose({400, 0, 100}, 1, 2, 30)) *
                                          pose({400, 50, 700}, 150, 40, -30) *
                                          pose({0, 60, 20}, 5, -7, 88);
  const RigidTransform found = inverse(camera_from_world(read.view()));
  EXPECT_LT((found.rotation - part_from_camera.rotation).norm(), 1e-12);
  EXPECT_LT((found.translation_mm - part_from_camera.translation_mm).norm(), 1e-9);
}

TEST(BaseFromFlange, NeedsThePartsPlaceAndSaysWhich) {
  EXPECT_EQ(
      read_text(std::string(kView) + kCameraOnFlange).first(),
      "scene.toml:2:12: viewpoint.0.base_from_flange: needs [cell.base_from_part]: the camera "
      "is on the flange, and where the part lies in the frame of the robot's base is not "
      "given");
  EXPECT_THAT(read_text(std::string(kView) + kCameraOnFlange + kOnPart).first(),
              HasSubstr("needs [cell.base_from_part]"));
  EXPECT_THAT(read_text(std::string(kView) + kBeside + kInCell).first(),
              HasSubstr("needs [cell.flange_from_part]"));
  EXPECT_THAT(read_text(std::string(kView) + kInCell).first(),
              HasSubstr("needs [calibration.flange_from_camera] or"));
}

TEST(BaseFromFlange, StandsInPlaceOfTheNineNumbers) {
  const ReadScene read = read_text(std::string("[[viewpoint]]\nup = [0, 1, 0]\n") +
                                   "base_from_flange = { translation_mm = [400, 50, 700] }\n" +
                                   kCameraOnFlange + kInCell);
  EXPECT_EQ(read.errors.size(), 1U);
  EXPECT_THAT(read.first(),
              HasSubstr("scene.toml:2:1: viewpoint.0.up: cannot be given beside base_from_flange"));
  EXPECT_THAT(read_text("[[viewpoint]]\nbase_from_flang = 1\n").first(),
              HasSubstr("the nearest known one is \"base_from_flange\""));
}

TEST(BaseFromFlange, IsWrittenAsItWasGiven) {
  const ReadScene read = read_text(in_hand() + "[[viewpoint]]\nposition_mm = [0, 0, 500]\n");
  ASSERT_EQ(read.first(),
            "scene.toml:1:3: viewpoint: a scan has exactly one [[viewpoint]]; "
            "position_mm, direction, up");
  const ConfigNode written = write_scene(read.scene);
  EXPECT_NE(written.at_path("viewpoint.0.base_from_flange.translation_mm"), nullptr);
  EXPECT_EQ(written.at_path("viewpoint.0.position_mm"), nullptr);
  EXPECT_EQ(written.at_path("viewpoint.1.base_from_flange"), nullptr);
  const ReadScene again = read_text(to_toml(written));
  EXPECT_EQ(again.scene.viewpoints[0].position_mm, read.scene.viewpoints[0].position_mm);
  EXPECT_EQ(to_toml(write_scene(again.scene)), to_toml(written));
}

TEST(BaseFromFlange, FollowsTablesThatAreReadAgain) {
  const std::string text = in_hand();
  ReadScene read = read_text(text);
  const ConfigNode changed =
      parse_toml("[cell.base_from_part]\ntranslation_mm = [400, 0, 200]\n", "set.toml");
  reread_scene(parse_toml(text, "scene.toml"), changed, read.scene, read.errors);
  ASSERT_EQ(read.first(), "");
  EXPECT_NEAR(read.view().position_mm[2], 480.0, kFlangeTolerance);
}

std::string resolved(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "s.toml", text);
  return resolved_text(load_study(folder / "s.toml", {}));
}

TEST(Schema, IsTwoOnlyWhereAFileNeedsIt) {
  EXPECT_THAT(resolved("[part]\n"), HasSubstr("schema = 1\n"));
  EXPECT_THAT(resolved("[part]\n"), Not(HasSubstr("calibration")));
  EXPECT_THAT(resolved("schema = 1\n[validate]\n"), HasSubstr("schema = 2\n"));
  EXPECT_THAT(resolved("schema = 2\n" + in_hand()), HasSubstr("[cell.base_from_part]"));
  EXPECT_THAT(resolved(resolved(in_hand())), HasSubstr("[calibration.flange_from_camera]"));
}

TEST(Schema, OfTheFutureIsRefused) {
  for (const char* schema : {"0", "3", "\"1\"", "1.0"}) {
    EXPECT_THROW(resolved(std::string("schema = ") + schema + "\n[part]\n"), ConfigError) << schema;
  }
}

TEST(Validate, RefusesKeysThatItDoesNotHave) {
  EXPECT_THAT(read_text("[validate]\nlimit = 3\n").first(),
              HasSubstr("scene.toml:2:1: validate.limit: unknown key"));
}

// A calibration that a file of its own holds, as glint calibrate writes it.
TEST(Calibration, IsTakenByInclude) {
  const TemporaryFolder folder;
  write_file(
      folder / "calibration.toml",
      std::string("schema = 2\n[camera]\nwidth_px = 640\nfocal_x_px = 600\n") + kCameraOnFlange);
  write_file(folder / "s.toml",
             std::string("schema = 1\ninclude = [\"calibration.toml\"]\n") + kView + kInCell);
  const Study study = load_study(folder / "s.toml", {});
  EXPECT_EQ(study.scene.camera.width_px, 640);
  EXPECT_NEAR(study.scene.viewpoint().position_mm[2], 580.0, kFlangeTolerance);
}

}  // namespace
}  // namespace glint
