// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/real_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "studies/acquire/acquired.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

std::string error_of(const std::filesystem::path& folder) {
  try {
    read_real_design("ring", folder);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// acquired.json of pictures of the views "a b", taken, and "c", rejected.
std::string acquired_json() {
  AcquiredPicture taken = {.view = "a b", .file = "views/a_b/one.png", .position_sigma_mm = 0.1};
  taken.base_from_flange.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  const AcquiredPicture rejected = {
      .view = "c", .file = "views/c/one.png", .is_accepted = false, .reason = "blurred"};
  return nlohmann::ordered_json{{"kind", "acquired"},
                                {"status", "partial"},
                                {"twin", true},
                                {"calibration", "calibration.toml"},
                                {"pictures", {picture_json(taken), picture_json(rejected)}}}
      .dump();
}

TEST(RealPictures, ReadsWhatWasAcquired) {
  const TemporaryFolder folder;
  make_folder(folder.path() / "views/a_b");
  write_file(folder.path() / "views/a_b/one.png", "x");
  write_file(folder.path() / "acquired.json", acquired_json());
  const RealDesign design = read_real_design("ring", folder.path());
  ASSERT_EQ(design.views.size(), 1U);
  EXPECT_EQ(design.views[0].name, "a b");
  EXPECT_EQ(design.views[0].picture, folder.path() / "views/a_b/one.png");
  EXPECT_DOUBLE_EQ(design.views[0].base_from_flange->translation_mm.z(), 3.0);
  EXPECT_DOUBLE_EQ(design.views[0].position_sigma_mm, 0.1);
  EXPECT_EQ(design.calibration, folder.path() / "calibration.toml");
  EXPECT_TRUE(design.is_of_twin);
  EXPECT_EQ(design.notes.size(), 2U);
}

// Its folder is not named as the view is.
TEST(RealPictures, TakesTheMeanOfAScan) {
  const TemporaryFolder folder;
  make_folder(folder.path() / "views/a_b");
  write_file(folder.path() / "views/a_b/one.png", "x");
  write_file(folder.path() / "views/a_b/aspect.png", "x");
  write_file(folder.path() / "acquired.json", acquired_json());
  EXPECT_EQ(read_real_design("ring", folder.path()).views[0].picture,
            folder.path() / "views/a_b/aspect.png");
}

// Two frames of it are there, and no mean.
TEST(RealPictures, LeavesOutAScanThatWasCutShort) {
  const TemporaryFolder folder;
  make_folder(folder.path() / "views/a");
  make_folder(folder.path() / "views/b");
  Json pictures = Json::array();
  for (const auto& [view, position] : {std::pair{"a", 0}, std::pair{"a", 1}, std::pair{"b", 0}}) {
    const std::string file = std::string("views/") + view + "/" + std::to_string(position) + ".png";
    write_file(folder.path() / file, "x");
    pictures.push_back(picture_json({.view = view, .position = position, .file = file}));
  }
  Json json = {{"kind", "acquired"}, {"status", "partial"}, {"twin", true}, {"pictures", pictures}};
  write_file(folder.path() / "acquired.json", json.dump());
  const RealDesign design = read_real_design("ring", folder.path());
  ASSERT_EQ(design.views.size(), 1U);
  EXPECT_EQ(design.views[0].name, "b");
  EXPECT_THAT(design.notes, testing::Contains(HasSubstr("ring: a is incomplete")));
  json["status"] = "stopped";
  write_file(folder.path() / "acquired.json", json.dump());
  EXPECT_THAT(error_of(folder.path()), HasSubstr("has no view whose scan is whole"));
}

TEST(RealPictures, ReadsTheStepOfTheCameraOffTheFirstFrame) {
  const TemporaryFolder folder;
  make_folder(folder.path() / "views/a_b");
  ImageF grey(4, 4);
  grey.values()[0] = 3.0F / 255.0F;
  write_png(folder.path() / "views/a_b/one.png", grey, PixelDepth::k8Bit);
  grey.values()[0] = 1.3F / 255.0F;
  write_png(folder.path() / "views/a_b/aspect.png", grey, PixelDepth::k16Bit);
  write_file(folder.path() / "acquired.json", acquired_json());
  const RealView view = read_real_design("ring", folder.path()).views[0];
  EXPECT_DOUBLE_EQ(camera_step(view, read_image(view.picture), 12), 1.0 / 255.0);
  EXPECT_LT(camera_step(read_image(view.picture), 12), 0.3 / 255.0) << "of the mean itself";
  EXPECT_DOUBLE_EQ(camera_step(ImageF(4, 4), 12), 1.0 / 4095.0) << "black";
  EXPECT_DOUBLE_EQ(camera_step(ImageF(4, 4), 0), 1.0 / 255.0) << "of an unknown sensor";
}

TEST(RealPictures, RefusesWhatIsNoListOfPictures) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "acquired.json";
  write_file(file, "{]");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("acquired.json: is no acquired.json"));
  write_file(file, R"({"kind": "acquired"})");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("acquired.json: is no acquired.json"));
  write_file(file, R"({"kind": "acquired", "pictures": [{"view": 3}]})");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("is no picture of glint acquire"));
  write_file(file, acquired_json());
  EXPECT_THAT(error_of(folder.path()), HasSubstr("one.png: there is no such file"));
  write_file(file, R"({"kind": "acquired", "pictures": []})");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("has no accepted picture"));
}

}  // namespace
}  // namespace glint
