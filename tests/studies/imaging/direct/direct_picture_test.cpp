// SPDX-License-Identifier: GPL-3.0-or-later
//
// render.method = "direct": pictures and scores beside those of path tracing.
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "metrics/statistics/estimate.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/path_picture.h"
#include "studies/imaging/scene_picture.h"
#include "tests/studies/imaging/direct/lamp_scene.h"

namespace glint::lamp_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::Not;
using ::testing::StartsWith;

ImageF radiance_of(const SceneSettings& scene, int threads = 2) {
  ThreadPool pool(threads);
  SceneStore store(pool);
  const auto picture = store.picture(scene);
  return frame_radiance(*picture, picture->frames.front());
}

Scores scores_of(const SceneSettings& scene, int threads = 2) {
  ThreadPool pool(threads);
  SceneStore store(pool);
  return evaluate(store, scene, {}, {}).scores;
}

/// A picture of paths, and what it is without each of its batches.
struct Traced {
  ImageF whole;
  std::vector<ImageF> without;
};

Traced traced_of(const SceneSettings& scene) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const auto picture = store.picture(by_paths(scene));
  Traced traced = {.whole = frame_radiance(*picture, picture->frames.front())};
  for (std::size_t b = 0; b < picture->batches.size(); ++b) {
    traced.without.push_back(frame_radiance(*picture, picture->frames.front(), b));
  }
  return traced;
}

double mean_of(const ImageF& image) {
  double sum = 0.0;
  for (const float value : image.values()) {
    sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(image.size());
}

/// How far a picture is from that of paths, in their standard errors.
struct Distance {
  double mean = 0.0;        ///< of the pictures' means
  double allowed = 0.0;     ///< three standard errors of it
  double chi_square = 0.0;  ///< mean over the pixels; about 1 where they agree
};

// The error of a pixel is known from 16 batches, 15 degrees of freedom: squares of distances over
// squares of errors have the mean 15 / 13. To the errors what sums may be wrong by is added.
Distance distance(const ImageF& picture, const Traced& traced) {
  constexpr double kMeanOfSquares = 15.0 / 13.0;
  constexpr double kSumError = 5e-4;
  Distance result = {.mean = mean_of(picture) - mean_of(traced.whole)};
  std::vector<double> means;
  for (const ImageF& without : traced.without) {
    means.push_back(mean_of(without));
  }
  result.allowed = 3.0 * jackknife_error(means);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    std::vector<double> values;
    for (const ImageF& without : traced.without) {
      values.push_back(static_cast<double>(without.values()[i]));
    }
    const double off = static_cast<double>(picture.values()[i] - traced.whole.values()[i]);
    const double error = std::hypot(jackknife_error(values), kSumError);
    result.chi_square += off * off / (error * error) / kMeanOfSquares;
  }
  result.chi_square /= static_cast<double>(picture.size());
  return result;
}

struct Case {
  const char* name;
  std::string lights;
  std::string width;
};

/// The whole range of widths, equal and unequal, and several lamps at once.
std::vector<Case> cases() {
  return {{"ring", kRing, "alpha = [0.2]\n"},
          {"dome", kDome, "alpha = [0.3]\n"},
          {"bar", kBar, "alpha = [0.1, 0.3]\n"},
          {"narrow lobe under a ring", kRing, "alpha = [0.05]\n"},
          {"narrow lobe under a dome", kDome, "alpha = [0.05]\n"},
          {"narrow lobe under a bar", kBar, "alpha = [0.05]\n"},
          {"widest lobe", kBar + kOtherBar, "roughness = 1\n"}};
}

TEST(DirectPicture, IsThatOfPathTracingWithinItsStandardError) {
  for (const Case& one : cases()) {
    const SceneSettings scene = lamp_scene(one.lights, one.width);
    const Traced traced = traced_of(scene);
    const Distance found = distance(radiance_of(scene), traced);
    fmt::print("{}: mean {:.5f} off {:+.5f}, allowed {:.5f}; chi square {:.3f}\n",
               one.name,
               mean_of(traced.whole),
               found.mean,
               found.allowed,
               found.chi_square);
    constexpr double kBias = 3e-4;  // of full scale
    EXPECT_LT(std::abs(found.mean), found.allowed + kBias) << one.name;
    EXPECT_LT(found.chi_square, 1.2) << one.name;
  }
}

TEST(DirectPicture, WithoutOneOfItsLampsIsAnother) {
  const Traced both = traced_of(lamp_scene(kBar + kOtherBar));
  const Distance right = distance(radiance_of(lamp_scene(kBar + kOtherBar)), both);
  const Distance wrong = distance(radiance_of(lamp_scene(kBar)), both);
  EXPECT_LT(right.chi_square, 1.2);
  EXPECT_GT(wrong.chi_square, 10.0);
  EXPECT_GT(std::abs(wrong.mean), 3.0 * wrong.allowed);
}

// Eight times the exposure of a lamp an eighth as bright is the same picture of grey values.
TEST(DirectPicture, IsAsExactInGreyValuesAtAnyExposure) {
  SceneSettings dim = lamp_scene(kRing);
  std::get<RingSettings>(dim.lights[0].settings).emission.radiance = {1.5 / 8.0};
  dim.sensor.exposure = 8.0;
  const ImageF bright = radiance_of(lamp_scene(kRing));
  const ImageF exposed = radiance_of(dim);
  for (std::size_t i = 0; i < bright.size(); ++i) {
    ASSERT_EQ(8.0F * exposed.values()[i], bright.values()[i]) << "powers of two change no digit";
  }
}

TEST(DirectPicture, HasTheScoresOfPathTracing) {
  SceneSettings scene = lamp_scene(kBar + kOtherBar);
  scene.sensor.full_well_e = 10000.0;
  scene.sensor.blur_px = 0.7;
  const Scores direct = scores_of(scene);
  const Scores paths = scores_of(by_paths(scene));
  for (const char* name : {"homogeneity.h_rms", "homogeneity.mean", "defects.dent_1.change"}) {
    const double error = paths.at(std::string(name) + ".error");
    fmt::print(
        "{}: {:.4f}, paths {:.4f} +- {:.4f}\n", name, direct.at(name), paths.at(name), error);
    EXPECT_NEAR(direct.at(name), paths.at(name), 0.002 + 3.0 * error) << name;
  }
}

// Its films are without noise; what is left is the sensor's.
TEST(DirectPicture, HasNoErrorsOfRenderingAndTheNoiseOfTheSensorAlone) {
  SceneSettings scene = lamp_scene(kRing);
  EXPECT_THAT(scores_of(scene), Not(Contains(Key(EndsWith(".error")))));
  EXPECT_THAT(scores_of(by_paths(scene)), Contains(Key(EndsWith(".error"))));
  SceneSettings again = scene;
  again.sensor.seed += 1000;
  EXPECT_EQ(scores_of(scene), scores_of(again)) << "a sensor without noise";
  scene.sensor.full_well_e = again.sensor.full_well_e = 10000.0;
  EXPECT_NE(scores_of(scene), scores_of(again));
}

// Radiance 1.5 is summed to the octave 1: interpolated within 5e-4 x 1.5, a fifth of it.
TEST(DirectPicture, TakesNoErrorOfInterpolationForAChange) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = lamp_scene(kRing);
  EXPECT_NEAR(picture_of(store, scene, {.has_flawless = true})->change_noise(), 1.5e-4, 1e-12);
  EXPECT_EQ(picture_of(store, scene, {.has_flawless = false})->change_noise(), 0.0)
      << "nothing is compared";
  scene.render.rays_per_axis = 4;
  EXPECT_NEAR(picture_of(store, scene, {.has_flawless = true})->change_noise(), 3.75e-5, 1e-12);
}

TEST(DirectPicture, IsTheSameForAnyNumberOfThreads) {
  const Scores one = scores_of(lamp_scene(kBar + kOtherBar), 1);
  EXPECT_EQ(one, scores_of(lamp_scene(kBar + kOtherBar), 2));
  EXPECT_EQ(one, scores_of(lamp_scene(kBar + kOtherBar), 7));
}

std::string error_of(const std::string& lights) {
  try {
    radiance_of(lamp_scene(lights));
    return "";
  } catch (const ConfigError& error) {
    return error.what();
  }
}

// The ring lies between the dome and the plate and hides some of it; either may be named.
TEST(DirectPicture, RefusesLampsThatMayHideEachOther) {
  EXPECT_THAT(error_of(kRing + kDome),
              AllOf(StartsWith("lighting.ring: may be hidden"), HasSubstr("\"paths\"")));
  EXPECT_EQ(error_of(kBar + kOtherBar), "");
  const std::string quarters = "segments = 4\nseparate_segments = true\n";
  EXPECT_EQ(error_of(kRing + quarters), "") << "quarters of a ring hide nothing of each other";
  EXPECT_EQ(error_of(kRing + "leds = 24\n"), "");
  EXPECT_EQ(error_of(kRing + "segments = 4\ntilt_deg = 30\n"), "") << "a cone around the plate";
}

TEST(DirectPicture, TellsWhichLampMayHideAnotherAndHowManyPiecesAreLookedAt) {
  EXPECT_THAT(error_of(kRing + kDome), HasSubstr("by lighting.dome"));
  EXPECT_THAT(error_of(kRing + "segments = 4\ntilt_deg = -60\n"),
              HasSubstr("by another part of itself"));
  EXPECT_THAT(error_of(kRing + "leds = 300\nled_diameter_mm = 0.2\n"),
              AllOf(StartsWith("lighting.ring: makes 300 luminous pieces"), HasSubstr("for 256")));
}

// All segments off, in one group or in one each: dark, whatever power is asked for.
TEST(DirectPicture, OfALampWhoseSegmentsAreOffIsDark) {
  const std::string ring = kRing.substr(0, kRing.find("radiance")) +
                           "power_w = [1]\nsegments = 2\nsegment_power = [0, 0]\n";
  for (const char* separate : {"", "separate_segments = true\n"}) {
    EXPECT_EQ(mean_of(radiance_of(lamp_scene(ring + separate))), 0.0) << separate;
  }
}

TEST(DirectPicture, IsExposedToWhatIsAskedFor) {
  SceneSettings scene = lamp_scene(kRing);
  scene.expose_to = 0.8;
  ThreadPool pool(2);
  SceneStore store(pool);
  const auto picture = picture_of(store, scene);
  EXPECT_GT(picture->scene().sensor.exposure, 1.0);
  const Evaluation evaluation = evaluate(store, scene, {}, {});
  EXPECT_LT(evaluation.scores.at("homogeneity.mean"), 0.8);
  EXPECT_GT(evaluation.scores.at("homogeneity.mean"), 0.5);
}

}  // namespace
}  // namespace glint::lamp_test
