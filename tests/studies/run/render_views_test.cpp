// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/render_views.h"

#include <chrono>
#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "simulator/render/path_tracing/tile_sums.h"
#include "studies/run/render_files.h"
#include "studies/run/render_maps.h"
#include "tests/studies/run/rendered_plate.h"
#include "tests/support/exr_reader.h"
#include "tests/support/page_data.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;
using test::channels_of;
using test::page_data;

TEST(RenderViews, WriteAScoredViewWithAllItsFiles) {
  const TemporaryFolder folder;
  const Json result = render(folder.path(), kScene);
  EXPECT_EQ(result["status"], "done");
  ASSERT_EQ(result["views"].size(), 1U);
  const Json& view = result["views"][0];
  EXPECT_EQ(view["samples"], 8);
  EXPECT_EQ(view["rays"]["camera"], 60 * 45 * 8);
  EXPECT_EQ(view["defects_seen"], 1);
  EXPECT_GT(view["relative_error"], 0.0);
  EXPECT_LT(view["relative_error"], 1.0);
  EXPECT_GT(result["scores"]["homogeneity.h_rms"], 0.1);
  EXPECT_TRUE(result["scores"].contains("homogeneity.h_rms.error"));
  for (const char* name : {"baseline/image.exr",
                           "baseline/image.png",
                           "baseline/image.tif",
                           "baseline/standard_error.exr",
                           "baseline/part_mask.png",
                           "baseline/mask.png",
                           "baseline/coverage.exr",
                           "baseline/geometry.exr",
                           "baseline/defects.png",
                           "baseline/side_by_side.png",
                           "baseline/defects.json",
                           "baseline/scene.toml",
                           "baseline/scores.json",
                           "baseline/aspect.exr",
                           "baseline/cross_section.svg",
                           "preview.png",
                           "result.json",
                           "run.json",
                           "report.html",
                           "study.resolved.toml"}) {
    EXPECT_TRUE(fs::exists(folder / "out" / name)) << name;
  }
  const Json written = Json::parse(read_file(folder / "out/result.json"));
  EXPECT_EQ(written["views"][0]["folder"], "baseline");
  EXPECT_FALSE(written["views"][0].contains("cpu_s")) << "times are in run.json alone";
}

/// The plate from so many viewpoints.
std::string plate_from(int count) {
  std::string text = kScene;
  for (int i = 0; i < count; ++i) {
    text += "[[viewpoint]]\nposition_mm = [" + std::to_string(i) +
            ", 0, 100]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\n";
  }
  return replaced(text, "samples = 8", "samples = 2");
}

TEST(RenderViews, RemoveViewsOfAnEarlierRendering) {
  const TemporaryFolder folder;
  const auto has = [&](const char* name) { return fs::exists(folder / "out" / name); };
  render(folder.path(), plate_from(5));
  EXPECT_TRUE(has("view_05"));
  render(folder.path(), plate_from(3));
  EXPECT_TRUE(has("view_03"));
  EXPECT_FALSE(has("view_04"));
  EXPECT_FALSE(has("view_05"));
  write_file(folder / "out/view_notes.txt", "mine");
  render(folder.path(), plate_from(1));
  EXPECT_TRUE(has("baseline"));
  EXPECT_FALSE(has("view_01"));
  EXPECT_FALSE(has("contact_sheet.png"));
  EXPECT_TRUE(has("view_notes.txt")) << "what is no view is not touched";
  render(folder.path(), plate_from(2));
  EXPECT_FALSE(has("baseline"));
}

TEST(RenderViews, RemoveNothingThatIsNotTheirs) {
  const TemporaryFolder folder;
  render(folder.path(), plate_from(2));
  const fs::path out = folder / "out";
  for (const char* name : {"view_1", "view_001", "view_2024.d"}) {
    fs::create_directory(out / name);
  }
  write_file(out / "view_2024", "mine");
  write_file(out / "view_77", "mine");
  render(folder.path(), plate_from(1));
  EXPECT_FALSE(fs::exists(out / "view_02"));
  for (const char* name : {"view_1", "view_001", "view_2024.d", "view_2024", "view_77"}) {
    EXPECT_TRUE(fs::exists(out / name)) << name;
  }
}

TEST(RenderViews, OfAnotherStudyAreRefused) {
  const TemporaryFolder folder;
  render(folder.path(), plate_from(1));
  write_file(folder / "other.toml", plate_from(1));
  const Study other = load_study(folder / "other.toml", {});
  try {
    render_views(other, {.out = folder / "out", .progress = Progress::Style::kNone});
    FAIL() << "it was rendered";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("holds results of `glint render` of "));
  }
}

TEST(RenderViews, KeepPicturesThatAreRead) {
  const TemporaryFolder folder;
  render(folder.path(), plate_from(1));
  const std::string text =
      replaced(plate_from(1),
               "roughness = 0.3",
               "roughness = 0.3\n[material.texture]\ncolour_file = \"out/baseline/image.png\"");
  const std::string before = read_file(folder / "out/baseline/image.png");
  EXPECT_THROW(render(folder.path(), text), ConfigError);
  EXPECT_EQ(read_file(folder / "out/baseline/image.png"), before);
}

TEST(RenderViews, TellThePageWhatItShows) {
  const TemporaryFolder folder;
  const Json result = render(folder.path(), kScene);
  const Json page = page_data(read_file(folder / "out/report.html"));
  EXPECT_EQ(page["title"], "Plate");
  EXPECT_EQ(page["verdict"]["sentence"], "1 view of 60 x 45 pixels by path tracing.");
  EXPECT_EQ(page["verdict"]["details"], result["notes"]);
  const Json& rendered = page["rendered"];
  EXPECT_EQ(rendered["scores"], Json::parse(read_file(folder / "out/result.json"))["scores"]);
  EXPECT_EQ(rendered["legend"][0], (Json{{"name", "dent"}, {"colour", "#d55e00"}}));
  EXPECT_EQ(rendered["legend"].size(), 3U) << "and the sound surface, and what is beside the part";
  EXPECT_FALSE(rendered.contains("sheet")) << "there is one view";
  ASSERT_EQ(rendered["views"].size(), 1U);
  EXPECT_EQ(rendered["views"][0]["rays"], result["views"][0]["rays"]);
  EXPECT_THAT(rendered["views"][0]["image"].get<std::string>(), ::testing::StartsWith("iVBOR"));
  EXPECT_THAT(rendered["drawing"].get<std::string>(), ::testing::StartsWith("<svg"));
}

// One frame: its channels' mean is the scored picture, noise included, to the rounding of 16 bits.
TEST(RenderViews, OfAColourSensorCarryTheNoiseThatWasScored) {
  const TemporaryFolder folder;
  render(folder.path(),
         replaced(kScene,
                  "bits = 0",
                  "bits = 0\nfull_well_e = 500\nread_noise_e = 5\nwavelengths_nm = [630, 532, "
                  "465]"));
  const auto written = channels_of(folder / "out/baseline/image.tif");
  const ImageF scored = channels_of(folder / "out/baseline/aspect.exr").begin()->second;
  ASSERT_EQ(written.size(), 3U);
  double largest = 0.0;
  for (std::size_t i = 0; i < scored.size(); ++i) {
    double mean = 0.0;
    for (const auto& [name, channel] : written) {
      mean += static_cast<double>(channel.values()[i]) / 3.0;
    }
    largest = std::max(largest, std::abs(mean - static_cast<double>(scored.values()[i])));
  }
  EXPECT_LT(largest, 1.0 / 65535.0);
}

TEST(RenderViews, KeepGroupsAtPowerOneThatAddUpToThePicture) {
  const TemporaryFolder folder;
  render(folder.path(), kScene);
  const auto image = channels_of(folder / "out/baseline/image.exr");
  ASSERT_EQ(image.size(), 3U);
  const auto shown = channels_of(folder / "out/baseline/image.tif");
  double maximum = 0.0;
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      // The ring's radiance is 1, the bar's 0.5; exposure 0.7 without blur and noise.
      const float sum = image.at("ring.Y")(x, y) + 0.5F * image.at("bar.Y")(x, y);
      EXPECT_NEAR(image.at("Y")(x, y), sum, 1e-5F * sum);
      EXPECT_NEAR(shown.begin()->second(x, y), std::min(1.0F, 0.7F * sum), 1.0F / 65535.0F);
      maximum = std::max(maximum, static_cast<double>(sum));
    }
  }
  EXPECT_GT(maximum, 0.01);
}

TEST(RenderViews, MaskEveryPixelOnce) {
  const TemporaryFolder folder;
  render(folder.path(), kScene);
  const auto coverage = channels_of(folder / "out/baseline/coverage.exr");
  const auto mask = channels_of(folder / "out/baseline/part_mask.png").begin()->second;
  const auto defects = channels_of(folder / "out/baseline/mask.png").begin()->second;
  ASSERT_EQ(coverage.size(), 3U);
  double dent_px = 0.0;
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      const float dent = coverage.at("defect.1")(x, y);
      const float background = coverage.at("background")(x, y);
      EXPECT_EQ(background + coverage.at("sound")(x, y) + dent, 1.0F);
      EXPECT_EQ(mask(x, y) > 0.5F, background == 0.0F);
      EXPECT_EQ(defects(x, y) > 0.5F, dent >= 0.5F);
      dent_px += static_cast<double>(dent);
    }
  }
  // A disc of 3 mm on pixels of 0.3 mm: pi 5^2 = 78.5 pixels.
  EXPECT_NEAR(dent_px, 78.5, 3.0);
}

// A dent of 0.25 mm fills pi 0.125^2 / 0.3^2 = 0.55 pixels of 0.3 mm: too little to be seen.
TEST(RenderViews, CountDefectsOfAtLeastOnePixelAsSeen) {
  const TemporaryFolder folder;
  const std::string speck = "[defects.speck]\nx_mm = [4]\ndiameter_mm = 0.25\nheight_um = 5\n";
  const Json result = render(folder.path(), kScene + speck);
  const Json defects = Json::parse(read_file(folder / "out/baseline/defects.json")).at("defects");
  ASSERT_EQ(defects.size(), 2U);
  EXPECT_NEAR(defects[1]["area_px"], 0.55, 0.3);
  EXPECT_EQ(result["views"][0]["defects_seen"], 1);
}

TEST(RenderViews, TellDepthAndPositionOfEachPixel) {
  const TemporaryFolder folder;
  render(folder.path(), kScene, {.has_light = false});
  const auto geometry = channels_of(folder / "out/baseline/geometry.exr");
  ASSERT_EQ(geometry.size(), 10U);
  const auto& depth = geometry.at("depth_mm");
  // The camera stands 100 mm above the origin and looks down.
  EXPECT_NEAR(depth(20, 15) + geometry.at("position_mm.z")(20, 15), 100.0F, 1e-4F);
  // Pixel 45 is 15.5 pixels right of the middle: 15.5 * 0.3 mm at 100 mm.
  const float x_mm = geometry.at("position_mm.x")(45, 22);
  EXPECT_NEAR(x_mm, 4.65F * depth(45, 22) / 100.0F, 0.05F);
  // The incidence there is atan(x / depth), for the normal stands upright.
  EXPECT_NEAR(geometry.at("incidence_deg")(45, 22),
              std::atan(x_mm / depth(45, 22)) * 180.0F / 3.14159265F,
              0.3F);
  EXPECT_NEAR(geometry.at("normal.z")(45, 22), 1.0F, 1e-5F);
  EXPECT_EQ(geometry.at("defect")(30, 22), 1.0F);
  EXPECT_EQ(geometry.at("defect")(45, 22), -1.0F);
  EXPECT_EQ(depth(0, 0), 0.0F) << "beside the part";
  EXPECT_EQ(geometry.at("triangle")(0, 0), -1.0F);
}

TEST(RenderViews, OfMasksCostNoLight) {
  const TemporaryFolder folder;
  render(folder.path(), kScene);
  const Json result = render(folder.path(), kScene, {.has_light = false});
  EXPECT_EQ(result["views"][0]["rays"]["shadow"], 0);
  EXPECT_EQ(result["views"][0]["rays"]["bounce"], 0);
  EXPECT_FALSE(result.contains("scores"));
  const fs::path view = folder / "out/baseline";
  EXPECT_TRUE(fs::exists(view / "mask.png"));
  for (const char* stale : {"image.png",
                            "image.exr",
                            "image.tif",
                            "standard_error.exr",
                            "scores.json",
                            "aspect.png",
                            "side_by_side.png"}) {
    EXPECT_FALSE(fs::exists(view / stale)) << stale << " of the rendering with light";
  }
}

TEST(RenderViews, NumberTheFoldersOfSeveral) {
  const TemporaryFolder folder;
  const std::string text =
      std::string(kScene) + "[viewpoints]\nsource = \"sphere\"\ncount = 3\npolar_max_deg = 30\n";
  const Json result = render(folder.path(), text);
  ASSERT_EQ(result["views"].size(), 3U);
  for (const char* name : {"view_01", "view_02", "view_03"}) {
    EXPECT_TRUE(fs::exists(folder / "out" / name / "image.exr")) << name;
    const Study again = load_study(folder / "out" / name / "scene.toml", {});
    EXPECT_EQ(again.scene.viewpoints.size(), 1U);
  }
  EXPECT_TRUE(fs::exists(folder / "out/contact_sheet.png"));
  EXPECT_TRUE(fs::exists(folder / "out/view_01/scores.json"));
  EXPECT_FALSE(fs::exists(folder / "out/view_02/scores.json"));
}

TEST(RenderViews, WriteTheSameBytesForAnyNumberOfThreads) {
  const TemporaryFolder one;
  const TemporaryFolder three;
  render(one.path(), kScene, {.threads = 1});
  render(three.path(), kScene, {.threads = 3});
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(one / "out")) {
    const fs::path name = fs::relative(entry.path(), one / "out");
    if (entry.is_regular_file() && name != "run.json") {
      const auto read = [&](const TemporaryFolder& folder) {
        return test::without_when(read_file(folder / "out" / name));
      };
      EXPECT_EQ(read(one), read(three)) << name;
      ++files;
    }
  }
  EXPECT_GT(files, 15);
}

/// Interrupted after the first pass, which shows in the preview.
Json interrupted_render(const TemporaryFolder& folder, const std::string& text) {
  std::atomic<int> interrupt = 0;
  fs::remove(folder / "out/preview.png");
  std::jthread user([&](const std::stop_token& stop) {
    while (!stop.stop_requested() && !fs::exists(folder / "out/preview.png")) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    interrupt = 1;
  });
  return render(folder.path(), text, {.interrupt = &interrupt});
}

TEST(RenderViews, ThatAreInterruptedKeepFinishedOnes) {
  const TemporaryFolder folder;
  render(folder.path(), plate_from(3));
  const Json result =
      interrupted_render(folder, replaced(plate_from(3), "samples = 2", "samples = 60000"));
  EXPECT_EQ(result["views"].size(), 1U);
  EXPECT_TRUE(fs::exists(folder / "out/view_02/image.exr"));
  EXPECT_TRUE(fs::exists(folder / "out/view_03/image.exr"));
}

TEST(RenderViews, ThatAreInterruptedKeepWhatThereIs) {
  const TemporaryFolder folder;
  const Json result =
      interrupted_render(folder, replaced(kScene, "samples = 8", "samples = 60000"));
  EXPECT_EQ(result["status"], "interrupted");
  ASSERT_EQ(result["views"].size(), 1U);
  EXPECT_LT(result["views"][0]["samples"], 60000);
  EXPECT_FALSE(result.contains("scores"));
  EXPECT_TRUE(fs::exists(folder / "out/baseline/image.exr"));
  EXPECT_TRUE(fs::exists(folder / "out/report.html"));
}

TEST(RenderViews, OfARefusedSceneLeaveNothingBehind) {
  const TemporaryFolder folder;
  const auto message = text_thrown_by<ConfigError>(
      [&] { render(folder.path(), replaced(kScene, "width_px = 60", "width_px = 60\nk1 = -90")); });
  EXPECT_THAT(message, ::testing::HasSubstr("scene.toml:"));
  EXPECT_FALSE(fs::exists(folder / "out"));
}

/// 2 x 1 pixels of 4 samples: the left sees 3 on the part, 2 of them on defect 5.
Film two_pixels() {
  Film sums = empty_film(2, 1, 0, 1, {5});
  sums.samples.values() = {4, 4};
  sums.part.values() = {3, 4};
  sums.defects[0].samples.values() = {2, 0};
  return sums;
}

DefectivePart made_with(DefectType type) {
  DefectivePart made;
  RealisedDefect defect;
  defect.defect.id = 5;
  defect.defect.type = type;
  defect.is_made = true;
  made.defects.push_back(defect);
  return made;
}

TEST(DefectMap, MixesColoursByCoverage) {
  const Film sums = two_pixels();
  EXPECT_EQ(defect_mask(sums).values(), (Mask::Values{1, 0}));
  EXPECT_EQ(whole_part_mask(sums).values(), (Mask::Values{0, 1}));
  // Blue in linear codes, sRGB (0, 114, 178): ((114/255 + 0.055) / 1.055)^2.4 = 0.1683, times 255
  // = 42.9; likewise 178: 0.4452, 113.5. Beside the part (40, 46, 52): 0.0212, 0.0273, 0.0343: 5,
  // 7, 9. Sound (206, 212, 217): 0.6172, 0.6584, 0.6939: 157, 168, 177.
  // Left pixel: 1/4 beside + 2/4 blue + 1/4 sound = (40.5, 65.25, 103.5) with blue's rounded code
  // (0, 43, 114).
  const ImageRgb map = defect_map(sums, made_with(DefectType::kBump));
  EXPECT_NEAR(map(0, 0)[0], 40.5, 0.6);
  EXPECT_NEAR(map(0, 0)[1], 65.25, 0.6);
  EXPECT_NEAR(map(0, 0)[2], 103.5, 0.6);
  EXPECT_EQ(map(1, 0), (std::array<std::uint8_t, 3>{157, 168, 177}));
}

TEST(Shrunk, KeepsTheMeanOfRandomPictures) {
  Rng rng(3, Stream::kTest, 0);
  for (int round = 0; round < 1000; ++round) {
    const int width = 1 + static_cast<int>(rng.next_u32() % 40);
    const int height = 1 + static_cast<int>(rng.next_u32() % 40);
    ImageRgb image(width, height);
    double mean = 0.0;
    for (auto& pixel : image.values()) {
      pixel = {static_cast<std::uint8_t>(rng.next_u32() % 256), 7, 255};
      mean += pixel[0] / static_cast<double>(image.size());
    }
    const int maximum = 1 + static_cast<int>(rng.next_u32() % 20);
    const ImageRgb small = shrunk(image, maximum);
    ASSERT_EQ(std::max(small.width(), small.height()), std::min(maximum, std::max(width, height)));
    double small_mean = 0.0;
    for (const auto& pixel : small.values()) {
      small_mean += pixel[0] / static_cast<double>(small.size());
      ASSERT_EQ(pixel[1], 7);
      ASSERT_EQ(pixel[2], 255);
    }
    ASSERT_NEAR(small_mean, mean, 0.51);
  }
}

TEST(SideBySide, LeavesAGapBetweenPicturesOfEqualSize) {
  const ImageRgb left(100, 40, {10, 20, 30});
  const ImageRgb right(100, 40, {200, 0, 0});
  const ImageRgb both = side_by_side(left, right, 50);
  EXPECT_EQ(both.height(), 20);
  EXPECT_EQ(both.width(), 104);  // two of 50 and the least gap of 4
  EXPECT_EQ(both(49, 19), left(0, 0));
  EXPECT_EQ(both(51, 5), (std::array<std::uint8_t, 3>{255, 255, 255}));
  EXPECT_EQ(both(54, 0), right(0, 0));
}

}  // namespace
}  // namespace glint
