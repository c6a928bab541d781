// SPDX-License-Identifier: GPL-3.0-or-later
//
// Masks and geometry are the same bytes with and without light.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/run/render_study.h"
#include "tests/studies/run/rendered_plate.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// The files that show what the camera sees, whatever the light.
void expect_same_masks(const std::string& text, const std::vector<std::string>& names) {
  const TemporaryFolder lit;
  const TemporaryFolder dark;
  render(lit.path(), text);
  render(dark.path(), text, {.has_light = false});
  for (const std::string& name : names) {
    EXPECT_EQ(read_file(lit / "out" / name), read_file(dark / "out" / name)) << name;
  }
}

std::vector<std::string> mask_files(const std::string& folder) {
  std::vector<std::string> names;
  for (const char* name :
       {"part_mask.png", "mask.png", "coverage.exr", "geometry.exr", "defects.png"}) {
    names.push_back(folder + "/" + name);
  }
  return names;
}

TEST(RenderMasks, AreTheSameWithAndWithoutLight) {
  expect_same_masks(kScene, mask_files("baseline"));
}

// Places end early once their error is small; masks have all samples all the same.
TEST(RenderMasks, AreTheSameWherePicturesEndEarly) {
  const std::string text = replaced(
      kScene, "samples = 8", "samples = 24\nmin_samples = 2\nrelative_error = 0.9\nbatches = 2");
  const TemporaryFolder folder;
  const Json result = render(folder.path(), text);
  ASSERT_LT(result["views"][0]["mean_samples"], 24.0) << "else nothing is tested";
  expect_same_masks(text, mask_files("baseline"));
}

TEST(RenderMasks, OfSeveralViewsAreTheSameWithAndWithoutLight) {
  const std::string text =
      std::string(kScene) + "[viewpoints]\nsource = \"sphere\"\ncount = 2\npolar_max_deg = 30\n";
  expect_same_masks(text, mask_files("view_01"));
  expect_same_masks(text, mask_files("view_02"));
}

// A defect beyond the picture: nothing is scored, so the picture has one batch.
TEST(RenderMasks, AreTheSameWhereNothingCanBeScored) {
  const std::string text = replaced(kScene, "width_px = 60", "width_px = 12");
  expect_same_masks(replaced(text, "diameter_mm = 3", "diameter_mm = 1\nx_mm = [7]"),
                    mask_files("baseline"));
}

// The mask of a mirror under a tunnel is the one its scan is scored in.
TEST(RenderMasks, TheMaskOfAMirrorIsThatOfItsScan) {
  const std::string text = R"(schema = 1
[part]
radius_along_mm = 300
length_mm = 60
width_mm = 30
rotation_deg = [0, 0, 17]
[camera]
width_px = 90
height_px = 60
object_pixel_mm = 0.8
working_distance_mm = 300
[scan]
positions = 4
[lighting.tunnel]
)";
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", text);
  const Study study = load_study(folder / "scene.toml", {});
  render_study(study, folder / "scan", 1);
  render(folder.path(), text, {.has_light = false});
  EXPECT_EQ(read_file(folder / "scan/baseline/part_mask.png"),
            read_file(folder / "out/baseline/part_mask.png"));
}

TEST(RenderViews, TellWhatALightHidesInEachView) {
  const TemporaryFolder folder;
  const std::string text = replaced(
      std::string(kScene) + "[viewpoints]\nsource = \"sphere\"\ncount = 2\npolar_max_deg = 30\n",
      "mount = \"camera\"",
      "mount = \"camera\"\nheight_mm = 50\ninner_radius_mm = 2");
  const std::vector<std::string> notes = render(folder.path(), text)["notes"];
  EXPECT_THAT(notes, testing::Contains(testing::HasSubstr("The back of lighting.ring hides")));
  EXPECT_THAT(notes, testing::Contains(testing::StartsWith("view_02: The back of lighting.ring")));
}

}  // namespace
}  // namespace glint
