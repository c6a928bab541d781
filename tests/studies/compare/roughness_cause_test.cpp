// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/roughness_cause.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/thread_pool.h"
#include "simulator/sensor/sensor.h"
#include "studies/compare/causes.h"
#include "studies/imaging/path_picture.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint::compare_detail {
namespace {

/// A plate of rough metal that fills the picture, under a bar from one side: its gloss fades
/// across.
std::string metal_plate_text(int width_px, double roughness) {
  return fmt::format(
      "schema = 1\n"
      "[part]\nshape = \"plate\"\nlength_mm = 60\nwidth_mm = 20\nthickness_mm = 2\n"
      "[material]\ntype = \"conductor\"\nroughness = {}\n"
      "[camera]\nwidth_px = {}\nheight_px = {}\nobject_pixel_mm = {}\n"
      "working_distance_mm = 100\n"
      "[lighting.bar]\nposition_mm = [0, 25, 90]\ndirection = [0, -0.25, -0.9]\n"
      "[sensor]\nexposure = 0.3\nbits = 12\n"
      "[render.paths]\nsamples = 32\nmax_reflections = 1\n",
      roughness,
      width_px,
      width_px / 5,
      50.0 / width_px);
}

SceneSettings metal_plate(int width_px, double roughness) {
  std::vector<Problem> errors;
  SceneSettings scene =
      read_scene(parse_toml(metal_plate_text(width_px, roughness), "plate.toml"), errors);
  throw_if_any(errors);
  return scene;
}

/// What the scene's camera would record, under a gain and by paths of another seed.
ImageF photographed(SceneSettings scene, ThreadPool& pool, double gain) {
  scene.paths.seed += 17;
  SceneStore store(pool);
  const auto picture = store.picture(scene);
  ImageF radiance = frame_radiance(*picture, picture->frames.front());
  for (float& value : radiance.values()) {
    value *= static_cast<float>(gain);
  }
  ImageF grey;
  Sensor(scene.sensor, radiance.width(), radiance.height()).expose(radiance, 0, grey);
  return grey;
}

/// Of metal that is 0.05 rougher than the scene says, under 0.9 times its exposure.
void expect_found(int width_px) {
  ThreadPool pool(2);
  const SceneSettings scene = metal_plate(width_px, 0.25);
  ComparedPair pair;
  pair.real.grey = photographed(metal_plate(width_px, 0.30), pool, 0.9);
  SceneStore store(pool);
  const auto fit = fit_roughness(pair, scene, store);
  ASSERT_TRUE(fit);
  std::printf("%d px: roughness %.4f +- %.4f, gain %.4f +- %.4f\n",
              width_px,
              fit->change,
              fit->sigma,
              fit->gain,
              fit->gain_sigma);
  EXPECT_NEAR(fit->change, 0.05, std::max(0.004, 4.0 * fit->sigma));
  EXPECT_LT(fit->sigma, 0.003);
  EXPECT_GT(fit->sigma, 0.5 * fit->bound);
  // The renderings' own noise, which is most of it here, is not in the bound.
  EXPECT_GT(fit->bound, 0.02 * fit->sigma);
  EXPECT_NEAR(fit->gain, 0.9, 0.01);
  EXPECT_GE(fit->renders, 2);
  EXPECT_LE(fit->renders, 3);
  EXPECT_EQ(store.num_rendered(), fit->renders);
}

TEST(FitRoughness, FindsItByThreePicturesAtMost) {
  expect_found(300);
}

// Beyond 612 px it renders at half the size.
TEST(FitRoughness, FindsItInAWiderPictureByThreePicturesAtMost) {
  expect_found(700);
}

// Somewhat rougher, much smoother, and a quarter as rough: the first is told within four sigmas,
// and how rough the others are is left open. By noise alone these would be 30 to 80 sigmas off.
TEST(FitRoughness, OfAnotherMetalIsHonestOrOpen) {
  constexpr double kOwn = 0.40;
  ThreadPool pool(2);
  int told = 0;
  for (const double real : {0.46, 0.25, 0.10}) {
    ComparedPair pair;
    pair.real.grey = photographed(metal_plate(120, real), pool, 1.0);
    SceneStore store(pool);
    const auto fit = fit_roughness(pair, metal_plate(120, kOwn), store);
    ASSERT_TRUE(fit);
    std::printf("%.2f: change %.4f +- %.4f (noise %.4f), gain %.4f +- %.4f%s\n",
                real,
                fit->change,
                fit->sigma,
                fit->noise_sigma,
                fit->gain,
                fit->gain_sigma,
                fit->is_within_reach ? "" : ", beyond reach");
    const double off = std::abs(kOwn + fit->change - real);
    if (fit->is_within_reach) {
      EXPECT_LE(off, 4.0 * fit->sigma) << real;
      EXPECT_LE(std::abs(fit->gain - 1.0), 4.0 * fit->gain_sigma) << real;
      told += std::abs(fit->change) >= 4.0 * fit->sigma ? 1 : 0;
    }
    EXPECT_EQ(fit->is_within_reach, real > 0.4);
    EXPECT_LE(fit->renders, 3);
  }
  EXPECT_EQ(told, 1);
}

/// The same plate before a sensor with so much of a dark signal.
SceneSettings dark_plate(int width_px, double roughness, double dark_grey) {
  SceneSettings scene = metal_plate(width_px, roughness);
  scene.sensor.full_well_e = 20000.0;
  scene.sensor.dark_e = dark_grey * scene.sensor.full_well_e;
  return scene;
}

// A dark signal of 0.05 of full scale is in the photograph and no light: taken for light it would
// make the gain too large.
TEST(FitRoughness, KnowsTheSensorsDarkSignal) {
  ThreadPool pool(2);
  ComparedPair pair;
  pair.real.grey = photographed(dark_plate(300, 0.30, 0.05), pool, 1.0);
  SceneStore store(pool);
  const auto fit = fit_roughness(pair, dark_plate(300, 0.25, 0.05), store);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->change, 0.05, std::max(0.004, 4.0 * fit->sigma));
  EXPECT_NEAR(fit->gain, 1.0, 0.01);
}

// Less light leaves the dark signal as it is: where it were taken to fade with it, a quarter of
// full scale would be 0.05 too dark.
TEST(FitRoughness, OfTheSameMetalUnderLessLightIsNoneBesideALargeDarkSignal) {
  ThreadPool pool(2);
  ComparedPair pair;
  pair.real.grey = photographed(dark_plate(160, 0.25, 0.25), pool, 0.8);
  SceneStore store(pool);
  const auto fit = fit_roughness(pair, dark_plate(160, 0.25, 0.25), store);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->change, 0.0, 4.0 * fit->sigma);
  EXPECT_NEAR(fit->gain, 0.8, std::max(0.002, 4.0 * fit->gain_sigma));
}

// A dark level that the scene does not have, where the pair's exposures may differ by an offset.
TEST(FitRoughness, AllowsAnOffsetWhereTheExposureMayHaveOne) {
  ThreadPool pool(2);
  ComparedPair pair;
  pair.real.grey = photographed(metal_plate(160, 0.30), pool, 0.8);
  for (float& grey : pair.real.grey.values()) {
    grey += 0.1F;
  }
  pair.appearance.exposure.offset = 0.1;
  SceneStore store(pool);
  const auto fit = fit_roughness(pair, metal_plate(160, 0.25), store);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->change, 0.05, std::max(0.004, 4.0 * fit->sigma));
  EXPECT_NEAR(fit->gain, 0.8, std::max(0.002, 4.0 * fit->gain_sigma));
}

TEST(FitRoughness, HasNoAnswerForAMirrorOrForAPictureOfAnotherSize) {
  ThreadPool pool(2);
  SceneStore store(pool);
  ComparedPair pair;
  pair.real.grey = ImageF(200, 40, 0.3F);
  EXPECT_FALSE(fit_roughness(pair, metal_plate(300, 0.25), store));
  EXPECT_FALSE(fit_roughness(pair, metal_plate(200, 0.01), store));
}

// Grey values of another place of the part say nothing of its metal.
TEST_F(CompareFiles, RoughnessIsNotSoughtWhereThePartMayLieElsewhere) {
  write_file(folder() / "scene.toml", metal_plate_text(300, 0.25));
  ThreadPool pool(2);
  ComparedPair pair;
  pair.simulated.source.scene = folder() / "scene.toml";
  pair.simulated.source.picture = folder() / "image.tif";
  pair.real.grey = ImageF(300, 60, 0.3F);
  pair.appearance.correlation = 0.9;
  for (const bool is_turned : {false, true}) {
    SceneStore store(pool);
    PairCauses causes = {.is_pose_doubtful = !is_turned};
    pair.better_turn =
        is_turned ? std::optional(BetterTurn{.name = "turned by 180 degrees"}) : std::nullopt;
    add_roughness(pair, store, causes);
    EXPECT_EQ(store.num_rendered(), 0);
    ASSERT_EQ(causes.notes.size(), 1U);
    EXPECT_NE(causes.notes[0].find("Roughness was not looked for"), std::string::npos);
  }
}

/// A photograph of the plate beside its simulation at a roughness of 0.4, with a gain told.
struct PlatePair {
  ComparedPair pair;
  PairCauses causes;
};

PlatePair plate_pair(const std::filesystem::path& folder, double real, ThreadPool& pool) {
  write_file(folder / "scene.toml", metal_plate_text(120, 0.4));
  PlatePair result;
  result.pair.simulated.source.scene = folder / "scene.toml";
  result.pair.simulated.source.picture = folder / "image.tif";
  result.pair.real.grey = photographed(metal_plate(120, real), pool, 1.0);
  result.pair.appearance.correlation = 0.9;
  result.causes.gain = 0.5;
  result.causes.told.push_back({.name = "gain", .value = 0.5, .sigma = 0.01, .of = "grey"});
  return result;
}

// Metal of another roughness makes a gain of none: neither is told where it is open how rough it
// is.
TEST_F(CompareFiles, RoughnessThatIsOpenHasANoteInThePlaceOfTheGain) {
  ThreadPool pool(2);
  PlatePair plates = plate_pair(folder(), 0.1, pool);
  SceneStore store(pool);
  add_roughness(plates.pair, store, plates.causes);
  EXPECT_TRUE(plates.causes.told.empty());
  EXPECT_EQ(plates.causes.gain, 1.0);
  EXPECT_EQ(plates.causes.roughness_change, 0.0);
  ASSERT_EQ(plates.causes.notes.size(), 1U);
  EXPECT_NE(plates.causes.notes[0].find("smoother than simulated (material.roughness = 0.4)"),
            std::string::npos)
      << plates.causes.notes[0];
}

TEST_F(CompareFiles, RoughnessIsNotSoughtWithoutCorrelation) {
  ThreadPool pool(2);
  PlatePair plates = plate_pair(folder(), 0.4, pool);
  plates.pair.appearance.correlation = -0.44;
  SceneStore store(pool);
  add_roughness(plates.pair, store, plates.causes);
  EXPECT_EQ(store.num_rendered(), 0);
  EXPECT_EQ(plates.causes.told.size(), 1U);
  ASSERT_EQ(plates.causes.notes.size(), 1U);
  EXPECT_NE(plates.causes.notes[0].find("correlate by -0.44 only"), std::string::npos);
}

TEST_F(CompareFiles, RoughnessThatPixelsDoNotTellHasANote) {
  ThreadPool pool(2);
  PlatePair plates = plate_pair(folder(), 0.4, pool);
  std::ranges::fill(plates.pair.real.grey.values(), 1.0F);  // clipped all over
  SceneStore store(pool);
  add_roughness(plates.pair, store, plates.causes);
  ASSERT_EQ(plates.causes.notes.size(), 1U);
  EXPECT_NE(plates.causes.notes[0].find("could not be fitted"), std::string::npos);
}

class UnsoughtRoughness : public CompareFiles {
 protected:
  /// Notes of a pair whose metal has a roughness, and one cause.
  std::vector<std::string> notes_of(double roughness, const std::string& cause) const {
    write_file(folder() / "scene.toml", metal_plate_text(300, roughness));
    ComparedPair pair;
    pair.simulated.source.scene = folder() / "scene.toml";
    PairCauses causes = {.told = {{.name = cause, .value = 1.1, .sigma = 0.01, .of = "grey"}}};
    note_unsought_roughness(pair, causes);
    return causes.notes;
  }
};

TEST_F(UnsoughtRoughness, IsNotedWhereMetalHasAGain) {
  const std::vector<std::string> notes = notes_of(0.25, "gain");
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("Roughness was not looked for (--roughness)"), std::string::npos);
  EXPECT_TRUE(notes_of(0.25, "k1").empty());
  EXPECT_TRUE(notes_of(0.01, "gain").empty());
}

}  // namespace
}  // namespace glint::compare_detail
