// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/reference/reference_scores.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/image/image_io.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/scene_picture.h"
#include "tests/studies/reference/photographed_plate.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::string kPhotographed = std::string(test::kPhotographedPlate) + R"([sensor]
bits = 0
blur_px = 0.8
[reference]
pictures = ["real.exr"]
)";

class ReferenceScores : public ::testing::Test {
 protected:
  /// Files that a study names must be there when it is read.
  ReferenceScores() {
    write_file(folder_ / "real.exr", "");
    write_file(folder_ / "mask.png", "");
  }

  Study study(const std::string& more = "") {
    write_file(folder_ / "study.toml", kPhotographed + more);
    return load_study(folder_ / "study.toml", {});
  }

  /// The scene's own picture becomes the real one.
  void photograph(SceneSettings scene) {
    scene.reference.reset();
    const auto picture = picture_of(store_, scene, {.has_flawless = false});
    write_exr(folder_ / "real.exr", picture->mean({.has_whole_frames = true}).aspect);
  }

  Scores scores_of(const SceneSettings& scene) { return reference_scores(store_, scene); }

  TemporaryFolder folder_;
  ThreadPool pool_{2};
  SceneStore store_{pool_};
};

TEST_F(ReferenceScores, OfTheSceneAgainstItselfArePerfect) {
  const Study same = study();
  photograph(same.scene);
  const Scores scores = scores_of(same.scene);
  EXPECT_NEAR(scores.at("overlap.iou"), 1.0, 1e-6);
  EXPECT_NEAR(scores.at("overlap.mean_distance_px"), 0.0, 1e-6);
  EXPECT_NEAR(scores.at("appearance.ssim"), 1.0, 1e-6);
  EXPECT_NEAR(scores.at("appearance.histogram_distance"), 0.0, 1e-6);
  EXPECT_NEAR(scores.at("appearance.rms"), 0.0, 1e-6);
}

// The plate is 60 x 40 pixels. Moved by 0.3 mm = 1.5 px along x, 1.5 of 60 columns leave: the
// intersection is 58.5, the union 61.5 wide. Both ends, 40 px each, are 1.5 px away; along the
// sides, 60 px each, nothing changes: 1.5 x 80 / 200 = 0.6 px.
TEST_F(ReferenceScores, TellHowFarThePartHasMoved) {
  const Study moved = study();
  SceneSettings scene = moved.scene;
  scene.part.position_mm = {0.3, 0.0, 0.0};
  photograph(scene);
  const Scores scores = scores_of(moved.scene);
  EXPECT_NEAR(scores.at("overlap.iou"), 58.5 / 61.5, 0.01);
  EXPECT_NEAR(scores.at("overlap.mean_distance_px"), 0.6, 0.1);
  EXPECT_LT(scores.at("appearance.ssim"), 0.99);
}

// 1.2 times the exposure: grey values grow by a fifth of their mean, and so does the distance.
TEST_F(ReferenceScores, TellAnotherExposure) {
  const Study study_of = study();
  SceneSettings brighter = study_of.scene;
  brighter.sensor.exposure = 1.2;
  photograph(brighter);
  const Scores scores = scores_of(study_of.scene);
  const auto picture = picture_of(store_, study_of.scene, {.has_flawless = false});
  const ImageF grey = picture->mean({.has_whole_frames = true}).aspect;
  const double middle = static_cast<double>(grey(48, 32));
  EXPECT_NEAR(scores.at("appearance.histogram_distance"), 0.2 * middle, 0.03 * middle);
  EXPECT_NEAR(scores.at("overlap.mean_distance_px"), 0.0, 0.02);
}

TEST_F(ReferenceScores, TakeTheMaskThatIsGiven) {
  const Study masked = study("masks = [\"mask.png\"]\n");
  photograph(masked.scene);
  Mask left(96, 64);
  for (int y = 12; y < 52; ++y) {
    for (int x = 18; x < 48; ++x) {
      left(x, y) = 1;  // half of the plate
    }
  }
  write_mask_png(folder_ / "mask.png", left);
  EXPECT_NEAR(scores_of(masked.scene).at("overlap.iou"), 0.5, 0.05);
  ImageF half(96, 64);
  std::ranges::transform(
      left.values(), half.values().begin(), [](auto a) { return 128.0F / 255.0F * a; });
  write_png(folder_ / "mask.png", half, PixelDepth::k8Bit);
  EXPECT_THAT([&] { scores_of(masked.scene); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("reference.masks.0"),
                                               HasSubstr("nowhere brighter than three quarters"))));
}

/// A dark square of 20 x 20 px in the middle of a picture of the plate.
ImageF printed_square() {
  ImageF ink(240, 160, 1.0F);
  for (int y = 40; y < 120; ++y) {
    for (int x = 80; x < 160; ++x) {
      ink(x, y) = 0.1F;
    }
  }
  return ink;
}

// The plate lies where it lay, the print on it is 0.3 mm = 1.5 px off: outlines agree, and of the
// square's four sides two are 1.5 px away, two run along.
TEST_F(ReferenceScores, TellHowFarAPrintHasMoved) {
  write_exr(folder_ / "ink.exr", printed_square());
  const Study printed = study(
      "[material.texture]\ncolour_file = \"ink.exr\"\nencoding = \"linear\"\nsize_mm = [12, 8]\n");
  photograph(printed.scene);
  EXPECT_LT(scores_of(printed.scene).at("overlap.edge_distance_px"), 0.01);
  SceneSettings scene = printed.scene;
  scene.material.texture.center_mm = {0.3, 0.0, 0.0};
  const Scores scores = scores_of(scene);
  EXPECT_NEAR(scores.at("overlap.edge_distance_px"), 0.75, 0.1);
  EXPECT_NEAR(scores.at("overlap.mean_distance_px"), 0.0, 0.02);
}

TEST_F(ReferenceScores, SayTheReachWhereNoEdgeHasACounterpart) {
  write_exr(folder_ / "ink.exr", printed_square());
  const Study plain = study();
  photograph(plain.scene);
  EXPECT_EQ(scores_of(plain.scene).at("overlap.edge_distance_px"), 8.0);
  SceneSettings printed = plain.scene;
  printed.material.texture.colour_file = folder_ / "ink.exr";
  printed.material.texture.encoding = TextureEncoding::kLinear;
  printed.material.texture.size_mm = {12.0, 8.0};
  EXPECT_EQ(scores_of(printed).at("overlap.edge_distance_px"), 8.0);
}

// Of two halves with independent noise, whose differences to the photograph are a and b: the square
// of their mean holds the noise, a b does not.
TEST_F(ReferenceScores, HaveTheNoiseOfPathsTakenOffWhereTheSceneSaysSo) {
  const Study masked = study("masks = [\"mask.png\"]\n");
  SceneSettings scene = masked.scene;
  scene.paths.samples = 8;
  scene.paths.batches = 2;
  SceneSettings taken = scene;
  taken.paths.seed += 17;
  taken.paths.samples = 64;
  photograph(taken);
  write_mask_png(folder_ / "mask.png", Mask(96, 64, 1));
  const auto picture = picture_of(store_, scene, {.has_flawless = false});
  ASSERT_EQ(picture->batches(), 2U);
  const ImageF first = picture->mean({.has_whole_frames = true, .without = 1}).aspect;
  const ImageF second = picture->mean({.has_whole_frames = true, .without = 0}).aspect;
  const ImageF real = linear_values(read_picture(folder_ / "real.exr").pixels);
  double square = 0.0;
  for (std::size_t i = 0; i < real.size(); ++i) {
    const auto grey = static_cast<double>(real.values()[i]);
    square += (static_cast<double>(first.values()[i]) - grey) *
              (static_cast<double>(second.values()[i]) - grey) / static_cast<double>(real.size());
  }
  const double with_noise = scores_of(scene).at("appearance.rms");
  scene.paths.has_bias_taken_off = true;
  const double without_noise = scores_of(scene).at("appearance.rms");
  EXPECT_NEAR(without_noise * std::abs(without_noise), square, 1e-8);
  EXPECT_GT(with_noise, 0.0);
  EXPECT_LT(without_noise, 0.8 * with_noise);
}

// Something that is not in the scene covers a corner of the plate: 10 x 10 of 60 x 40 pixels, a
// difference of 0.5 there is one of 0.5 sqrt(100 / 2400) in all.
TEST_F(ReferenceScores, CompareNothingWhereAMaskIsGrey) {
  const Study masked = study("masks = [\"mask.png\"]\n");
  photograph(masked.scene);
  ImageF real = linear_values(read_picture(folder_ / "real.exr").pixels);
  ImageF mask(96, 64);
  for (int y = 12; y < 52; ++y) {
    for (int x = 18; x < 78; ++x) {
      const bool is_covered = x < 28 && y < 22;
      mask(x, y) = is_covered ? 0.5F : 1.0F;
      real(x, y) += is_covered ? 0.5F : 0.0F;
    }
  }
  write_exr(folder_ / "real.exr", real);
  write_png(folder_ / "mask.png", mask, PixelDepth::k8Bit);
  EXPECT_NEAR(scores_of(masked.scene).at("appearance.rms"), 0.0, 1e-6);
  EXPECT_NEAR(scores_of(masked.scene).at("appearance.histogram_distance"), 0.0, 1e-3);
  write_mask_png(folder_ / "mask.png", Mask(96, 64, 1));
  const double whole = std::sqrt(100.0 / (96.0 * 64.0));
  EXPECT_NEAR(scores_of(masked.scene).at("appearance.rms"), 0.5 * whole, 1e-3);
}

// The plate where it is, a bright gripper over 20 x 20 of its 60 x 40 pixels, at its rim: what is
// covered is taken off both sides, outlines and the surroundings that SSIM sees, too.
TEST_F(ReferenceScores, CompareNoOutlinesWhereAMaskIsGrey) {
  const Study masked = study("masks = [\"mask.png\"]\n");
  photograph(masked.scene);
  ImageF real = linear_values(read_picture(folder_ / "real.exr").pixels);
  ImageF mask(96, 64);
  for (int y = 12; y < 52; ++y) {
    for (int x = 18; x < 78; ++x) {
      const bool is_covered = x < 38 && y < 32;
      mask(x, y) = is_covered ? 0.5F : 1.0F;
      real(x, y) = is_covered ? 1.0F : real(x, y);
    }
  }
  write_exr(folder_ / "real.exr", real);
  write_png(folder_ / "mask.png", mask, PixelDepth::k8Bit);
  const Scores scores = scores_of(masked.scene);
  std::printf("iou %.5f, distance %.5f px, ssim %.6f\n",
              scores.at("overlap.iou"),
              scores.at("overlap.mean_distance_px"),
              scores.at("appearance.ssim"));
  EXPECT_GT(scores.at("overlap.iou"), 0.999);
  EXPECT_LT(scores.at("overlap.mean_distance_px"), 0.01);
  EXPECT_NEAR(scores.at("appearance.ssim"), 1.0, 1e-5);
  SceneSettings moved = masked.scene;
  moved.part.position_mm = {0.3, 0.0, 0.0};
  EXPECT_GT(scores_of(moved).at("overlap.mean_distance_px"), 0.3);
  write_png(folder_ / "mask.png", ImageF(96, 64, 0.5F), PixelDepth::k8Bit);
  EXPECT_THROW(scores_of(masked.scene), ConfigError);
}

// The same plate by a camera of twice the pixels along both sides: its picture, reduced, is that of
// the scene's camera up to the noise of 16 samples a pixel.
TEST_F(ReferenceScores, ReduceAPhotographOfMorePixels) {
  const Study small = study("masks = [\"mask.png\"]\n");
  SceneSettings large = small.scene;
  large.camera.width_px = 192;
  large.camera.height_px = 128;
  large.camera.object_pixel_mm = 0.1;
  large.sensor.blur_px = 1.6;
  photograph(large);
  Mask plate(192, 128);
  for (int y = 24; y < 104; ++y) {
    for (int x = 36; x < 156; ++x) {
      plate(x, y) = 1;
    }
  }
  write_mask_png(folder_ / "mask.png", plate);
  const Scores scores = scores_of(small.scene);
  EXPECT_LT(scores.at("appearance.rms"), 0.01);
  EXPECT_LT(scores.at("overlap.mean_distance_px"), 0.05);
  write_exr(folder_ / "real.exr", ImageF(192, 64, 0.5F));
  EXPECT_THAT([&] { scores_of(small.scene); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("192 x 64"), HasSubstr("whole number"))));
}

TEST_F(ReferenceScores, AreScoresOfAStudy) {
  const Study fitted = study(
      "[variables]\n\"sensor.exposure\" = { min = 0.5, max = 2 }\n"
      "[objective]\nminimise = \"appearance.rms\"\n");
  photograph(fitted.scene);
  const Scores scores = evaluate(store_, fitted.scene, {}, wanted_by(fitted.goal)).scores;
  EXPECT_NEAR(scores.at("appearance.rms"), 0.0, 1e-6);
  EXPECT_EQ(scores.count("homogeneity.h_rms"), 0U);
}

// Edges inside the part are fitted for those who ask, and for the designs that are written.
TEST_F(ReferenceScores, HaveInnerEdgesWhereTheyAreAskedFor) {
  const std::string edges = "overlap.edge_distance_px";
  const std::string variables = "[variables]\n\"sensor.exposure\" = { min = 0.5, max = 2 }\n";
  const Study plain = study(variables + "[objective]\nminimise = \"appearance.rms\"\n");
  photograph(plain.scene);
  const auto has_edges = [&](const WantedScores& wanted) {
    return evaluate(store_, plain.scene, {}, wanted).scores.count(edges) > 0;
  };
  EXPECT_FALSE(has_edges(wanted_by(plain.goal)));
  WantedScores of_design = wanted_by(plain.goal).with_whole_scan();
  of_design.picture = false;
  EXPECT_TRUE(has_edges(of_design));
  EXPECT_TRUE(has_edges(
      wanted_by(study(variables + "[objective]\nminimise = \"appearance.rms\"\n[constraints]\n\"" +
                      edges + "\" = { max = 0.5 }\n")
                    .goal)));
}

TEST_F(ReferenceScores, NeedRealPictures) {
  std::string text = kPhotographed;
  text.resize(text.find("[reference]"));
  write_file(folder_ / "study.toml", text + "[objective]\nmaximise = \"appearance.ssim\"\n");
  EXPECT_THAT([&] { load_study(folder_ / "study.toml", {}); },
              ThrowsMessage<ConfigError>(HasSubstr("[reference]")));
}

TEST_F(ReferenceScores, RefusePicturesThatDoNotFit) {
  const Study fitted = study();
  EXPECT_THAT([&] { scores_of(fitted.scene); },
              ThrowsMessage<ConfigError>(HasSubstr("is no picture")));
  write_exr(folder_ / "real.exr", ImageF(90, 64, 0.5F));
  EXPECT_THAT([&] { scores_of(fitted.scene); },
              ThrowsMessage<ConfigError>(AllOf(
                  HasSubstr("reference.pictures.0"), HasSubstr("90 x 64"), HasSubstr("96 x 64"))));
  write_exr(folder_ / "real.exr", ImageF(96, 64));
  EXPECT_THAT([&] { scores_of(fitted.scene); },
              ThrowsMessage<ConfigError>(HasSubstr("the part is not found")));
  write_exr(folder_ / "real.exr", ImageF(96, 64, std::nanf("")));
  EXPECT_THAT([&] { scores_of(fitted.scene); },
              ThrowsMessage<ConfigError>(HasSubstr("no finite numbers")));
  SceneSettings scene = fitted.scene;
  scene.reference->pictures.push_back(scene.reference->pictures.front());
  EXPECT_THAT([&] { scores_of(scene); },
              ThrowsMessage<ConfigError>(HasSubstr("are 2, the scene has 1 viewpoint")));
}

}  // namespace
}  // namespace glint
