// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/render_ladder.h"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "studies/definition/render_methods.h"

namespace glint {
namespace {

using Method = RenderSettings::Method;
using ::testing::ElementsAre;

SceneSettings mirror() {
  SceneSettings scene;
  scene.camera.width_px = 1000;
  scene.camera.height_px = 500;
  scene.scan.positions = 10;
  return scene;
}

SceneSettings rough() {
  SceneSettings scene = mirror();
  scene.render.method = Method::kPaths;
  return scene;
}

std::vector<std::string> names(const std::vector<RenderRung>& ladder) {
  std::vector<std::string> list;
  std::ranges::transform(ladder, std::back_inserter(list), &RenderRung::name);
  return list;
}

std::vector<std::string> names_for_search(std::vector<RenderRung> ladder) {
  std::erase_if(ladder, [](const RenderRung& rung) { return !rung.is_for_search; });
  return names(ladder);
}

TEST(RenderLadder, OfAMirrorRisesFromLooseFootprintsToWholeFrames) {
  const auto ladder = render_ladder(mirror(), {});
  EXPECT_THAT(names(ladder),
              ElementsAre("means of footprints to 2 mrad",
                          "means of footprints to 0.6 mrad",
                          "means of footprints to 0.2 mrad",
                          "means of footprints to 0.06 mrad",
                          "frames of footprints to 0.05 mrad"));
  EXPECT_TRUE(std::ranges::all_of(ladder, &RenderRung::is_for_search));
  EXPECT_TRUE(ladder.front().has_derivatives);
  EXPECT_FALSE(ladder.back().has_derivatives);
}

TEST(RenderLadder, OfPathsHasReflectionsTimesSamples) {
  SceneSettings scene = rough();
  scene.paths.samples = 16;
  scene.paths.max_reflections = 2;
  EXPECT_THAT(names(render_ladder(scene, {})),
              ElementsAre("half resolution, 2 reflections, 8 samples",
                          "half resolution, 2 reflections, 32 samples",
                          "direct light, 8 samples",
                          "2 reflections, 8 samples",
                          "direct light, 16 samples",
                          "2 reflections, 16 samples",
                          "direct light, 32 samples",
                          "2 reflections, 32 samples",
                          "direct light, 64 samples",
                          "2 reflections, 64 samples"));
}

TEST(RenderLadder, KeptReflectionsAreThoseOfEveryRung) {
  SceneSettings scene = rough();
  scene.paths.max_reflections = 4;
  for (const RenderRung& rung : render_ladder(scene, {.reflections = true})) {
    EXPECT_EQ(at_rung(scene, rung).paths.max_reflections, 4) << rung.name;
  }
  EXPECT_THAT(names(render_ladder(scene, {})), testing::Contains("direct light, 8 samples"));
}

TEST(RenderLadder, OfHalfResolutionHasAQuarterOfThePixels) {
  SceneSettings scene = rough();
  scene.paths.samples = 32;
  scene.paths.max_reflections = 3;
  const auto ladder = render_ladder(scene, {});
  int halves = 0;
  for (const RenderRung& rung : ladder) {
    const SceneSettings at = at_rung(scene, rung);
    halves += rung.pixel_factor == 2 ? 1 : 0;
    EXPECT_EQ(at.camera.width_px, scene.camera.width_px / rung.pixel_factor) << rung.name;
    EXPECT_EQ(at_rung(mirror(), rung).camera.width_px, 1000) << "a mirror keeps its pixels";
    EXPECT_DOUBLE_EQ(rung.work, counted_work(at)) << rung.name;
  }
  EXPECT_EQ(halves, 3) << "8, 32, 128 samples";
  EXPECT_EQ(ladder.back().pixel_factor, 1);
  for (const KeptKeys& kept : {KeptKeys{.samples = true}, KeptKeys{}}) {
    for (const RenderRung& rung : render_ladder(scene, kept)) {
      EXPECT_LE(rung.paths.samples, kept.samples && rung.is_for_search ? 32 : 128) << rung.name;
    }
  }
}

TEST(RenderLadder, OfFewPixelsOrAKeptCameraHasNoHalfResolution) {
  const auto has_half = [](const SceneSettings& scene, const KeptKeys& kept) {
    return std::ranges::any_of(render_ladder(scene, kept),
                               [](const RenderRung& rung) { return rung.pixel_factor > 1; });
  };
  SceneSettings scene = rough();
  EXPECT_TRUE(has_half(scene, {}));
  EXPECT_FALSE(has_half(scene, {.resolution = true}));
  EXPECT_FALSE(has_half(mirror(), {}));
  scene.camera.height_px = 63;
  EXPECT_FALSE(has_half(scene, {}));
  scene = rough();
  scene.reference.emplace();
  EXPECT_FALSE(has_half(scene, {})) << "real pictures have all pixels";
}

TEST(RenderLadder, MeanErrorsAreTakenOutOfWhatTheRungRenders) {
  RenderRung rung;
  rung.offsets = {{"homogeneity.h_rms", -0.25}, {"defects.min_weber", 0.5}};
  std::map<std::string, double> scores = {{"homogeneity.h_rms", 0.5}, {"homogeneity.mean", 0.75}};
  less_offsets(rough(), rung, scores);
  EXPECT_EQ(scores.at("homogeneity.h_rms"), 0.75);
  EXPECT_EQ(scores.at("homogeneity.mean"), 0.75);
  less_offsets(mirror(), rung, scores);
  EXPECT_EQ(scores.at("homogeneity.h_rms"), 0.75) << "a mirror is rendered in all its pixels";
}

// The top of 12 samples is judged by a rung of at most half as many.
TEST(RenderLadder, OfFewSamplesBeginsBelowHalfOfItsTop) {
  SceneSettings scene = rough();
  scene.paths.max_reflections = 1;
  for (const auto& [samples, first] : {std::pair{1, 2}, std::pair{2, 4}, std::pair{3, 4}}) {
    scene.paths.samples = samples;
    const auto ladder = render_ladder(scene, {.resolution = true});
    EXPECT_EQ(ladder.front().paths.samples, first) << samples;
    EXPECT_LE(2 * ladder.front().paths.samples, ladder.back().paths.samples) << samples;
  }
}

TEST(RenderLadder, EndsWhereFinalistsAreRescored) {
  for (const SceneSettings& scene : {mirror(), rough()}) {
    for (const KeptKeys& kept : {KeptKeys{}, KeptKeys{.method = true, .samples = true}}) {
      const auto ladder = render_ladder(scene, kept);
      const SceneSettings top = at_rung(scene, ladder.back());
      const SceneSettings finer = rescoring_settings(scene);
      EXPECT_EQ(top.paths.samples, finer.paths.samples);
      EXPECT_EQ(top.render.method, finer.render.method);
      EXPECT_EQ(top.render.max_direction_error_rad, finer.render.max_direction_error_rad);
      EXPECT_EQ(top.paths.seed, scene.paths.seed) << "common random numbers";
      EXPECT_EQ(top.sensor.seed, scene.sensor.seed);
    }
  }
}

TEST(RenderLadder, RisesInWorkAndNamesEachRungOnce) {
  for (const SceneSettings& scene : {mirror(), rough()}) {
    const auto ladder = render_ladder(scene, {});
    EXPECT_TRUE(std::ranges::is_sorted(ladder, {}, &RenderRung::work));
    const auto list = names(ladder);
    EXPECT_EQ(std::set<std::string>(list.begin(), list.end()).size(), ladder.size());
  }
}

TEST(RenderLadder, KeptSamplesAreTheMostOfASearch) {
  SceneSettings scene = rough();
  scene.paths.samples = 24;
  scene.paths.max_reflections = 1;
  const auto ladder = render_ladder(scene, {.samples = true, .resolution = true});
  EXPECT_THAT(
      names_for_search(ladder),
      ElementsAre(
          "direct light, 8 samples", "direct light, 16 samples", "direct light, 24 samples"));
  EXPECT_EQ(ladder.back().name, "direct light, 96 samples");
  EXPECT_FALSE(ladder.back().is_for_search);
}

TEST(RenderLadder, KeptFootprintsLeaveNothingToChoose) {
  SceneSettings scene = mirror();
  scene.render.max_direction_error_rad = 1e-4;
  const auto ladder = render_ladder(scene, {.method = true, .max_direction_error = true});
  EXPECT_THAT(names_for_search(ladder), ElementsAre("means of footprints to 0.1 mrad"));
}

TEST(RenderLadder, AKeptMethodIsTheMethodOfEveryRungOfASearch) {
  SceneSettings scene = mirror();
  scene.render.method = Method::kSampled;
  EXPECT_THAT(names_for_search(render_ladder(scene, {.method = true})),
              ElementsAre("1 ray a pixel", "4 rays a pixel", "16 rays a pixel"));
  scene.render.method = Method::kIntegrated;
  for (const RenderRung& rung : render_ladder(scene, {.method = true})) {
    EXPECT_EQ(rung.render.method, Method::kIntegrated);
    EXPECT_FALSE(rung.has_derivatives);
  }
}

/// Metal in the range of blurred reflections.
SceneSettings satin() {
  SceneSettings scene = mirror();
  scene.material.type = MaterialSettings::Type::kConductor;
  scene.material.alpha = {0.05};
  scene.paths.max_reflections = 1;
  return scene;
}

bool has_blurred(const std::vector<RenderRung>& ladder) {
  return std::ranges::any_of(ladder,
                             [](const RenderRung& rung) { return rung.level == "blurred"; });
}

TEST(RenderLadder, OfSatinMetalHasBlurredReflectionsBelowItsTop) {
  SceneSettings scene = satin();
  scene.paths.samples = 256;
  const auto ladder = render_ladder(scene, {});
  std::vector<std::string> blurred;
  for (const RenderRung& rung : ladder) {
    if (rung.level == "blurred") {
      blurred.push_back(rung.name);
      EXPECT_EQ(rung.render.method, Method::kBlurred);
      EXPECT_FALSE(rung.is_noisy);
      EXPECT_TRUE(rung.is_summed);
      EXPECT_FALSE(rung.has_derivatives);
      EXPECT_LT(rung.work, ladder.back().work);
    }
  }
  EXPECT_THAT(
      blurred,
      ElementsAre("blurred, 1 ray a pixel", "blurred, 4 rays a pixel", "blurred, 16 rays a pixel"));
  EXPECT_EQ(ladder.back().name, "direct light, 1024 samples") << "paths judge";
}

TEST(RenderLadder, HasBlurredReflectionsNowhereElse) {
  EXPECT_FALSE(has_blurred(render_ladder(satin(), {.method = true}))) << "as the user says";
  SceneSettings rougher = satin();
  rougher.material.alpha = {0.3};
  EXPECT_FALSE(has_blurred(render_ladder(rougher, {})));
  EXPECT_FALSE(has_blurred(render_ladder(mirror(), {})));
  EXPECT_FALSE(has_blurred(render_ladder(rough(), {})));
  SceneSettings quick = satin();
  quick.paths.samples = 1;
  quick.scan.positions = 2;
  EXPECT_FALSE(has_blurred(render_ladder(quick, {}))) << "they would be dearer than the top";
}

TEST(RenderLadder, OfBlurredReflectionsHasMoreRays) {
  SceneSettings scene = satin();
  scene.render.method = Method::kBlurred;
  const auto ladder = render_ladder(scene, {.method = true});
  EXPECT_THAT(
      names(ladder),
      ElementsAre("blurred, 1 ray a pixel", "blurred, 4 rays a pixel", "blurred, 16 rays a pixel"));
  EXPECT_EQ(fineness_of(ladder.back()), 16.0);
}

TEST(AtRung, OfBlurredReflectionsOthersFollowTheirPaths) {
  SceneSettings scene = satin();
  scene.paths.samples = 256;
  const auto ladder = render_ladder(scene, {});
  const auto rung = *std::ranges::find(ladder, "blurred", &RenderRung::level);
  EXPECT_EQ(at_rung(scene, rung).render.method, Method::kBlurred);
  EXPECT_EQ(at_rung(scene, rung).render.rays_per_axis, rung.render.rays_per_axis);
  SceneSettings rougher = scene;
  rougher.material.alpha = {0.3};
  rougher.paths.samples = 8;
  EXPECT_EQ(at_rung(rougher, rung).render.method, Method::kAuto);
  EXPECT_EQ(at_rung(rougher, rung).paths.samples, 256);
  EXPECT_EQ(at_rung(mirror(), rung).render.method, Method::kAuto) << "a mirror stays one";
}

/// Metal under a ring.
SceneSettings steel() {
  SceneSettings scene = satin();
  scene.has_tunnel = false;
  scene.lights = {{.name = "ring", .settings = RingSettings{}}};
  scene.material.alpha = {0.2};
  scene.paths.samples = 32;
  return scene;
}

std::vector<std::string> direct_sums(const std::vector<RenderRung>& ladder) {
  std::vector<std::string> list;
  for (const RenderRung& rung : ladder) {
    if (rung.level == "direct sum") {
      list.push_back(rung.name);
      EXPECT_EQ(rung.render.method, Method::kDirect);
      EXPECT_FALSE(rung.is_noisy);
      EXPECT_TRUE(rung.is_summed);
      EXPECT_FALSE(rung.has_derivatives);
    }
  }
  return list;
}

TEST(RenderLadder, OfMetalUnderLampsHasDirectSumsBelowItsTop) {
  const auto ladder = render_ladder(steel(), {});
  EXPECT_THAT(direct_sums(ladder),
              ElementsAre("direct sum, 1 ray a pixel",
                          "direct sum, 4 rays a pixel",
                          "direct sum, 16 rays a pixel"));
  EXPECT_EQ(ladder.back().name, "direct light, 128 samples") << "paths judge";
}

TEST(RenderLadder, HasDirectSumsNowhereElse) {
  EXPECT_THAT(direct_sums(render_ladder(steel(), {.method = true})), ElementsAre());
  EXPECT_THAT(direct_sums(render_ladder(satin(), {})), ElementsAre());
  EXPECT_THAT(direct_sums(render_ladder(rough(), {})), ElementsAre());
  SceneSettings lit = steel();
  lit.lights.push_back({.name = "sky", .settings = EnvironmentSettings{}});
  EXPECT_THAT(direct_sums(render_ladder(lit, {})), ElementsAre());
  SceneSettings two = steel();
  two.lights.push_back({.name = "bar", .settings = BarSettings{}});
  EXPECT_THAT(direct_sums(render_ladder(two, {})), ElementsAre()) << "one might hide the other";
  SceneSettings many_rays = steel();
  many_rays.render.rays_per_axis = 16;
  EXPECT_THAT(direct_sums(render_ladder(many_rays, {.rays_per_axis = true})), ElementsAre());
}

TEST(RenderLadder, OfDirectSumsHasMoreRays) {
  SceneSettings scene = steel();
  scene.render.method = Method::kDirect;
  const std::vector<std::string> all = {
      "direct sum, 1 ray a pixel", "direct sum, 4 rays a pixel", "direct sum, 16 rays a pixel"};
  EXPECT_EQ(names(render_ladder(scene, {.method = true})), all);
  scene.render.rays_per_axis = 4;
  EXPECT_THAT(names(render_ladder(scene, {.method = true, .rays_per_axis = true})),
              ElementsAre("direct sum, 16 rays a pixel"));
}

TEST(AtRung, OfDirectSumsOthersFollowTheirPaths) {
  const auto ladder = render_ladder(steel(), {});
  const auto rung = *std::ranges::find(ladder, "direct sum", &RenderRung::level);
  EXPECT_EQ(at_rung(steel(), rung).render.method, Method::kDirect);
  SceneSettings lit = steel();
  lit.lights.push_back({.name = "sky", .settings = EnvironmentSettings{}});
  EXPECT_EQ(at_rung(lit, rung).render.method, Method::kAuto);
  EXPECT_EQ(at_rung(mirror(), rung).render.method, Method::kAuto) << "a mirror stays one";
}

TEST(KeysInFile, AreThoseThatAreWritten) {
  const auto kept = [](const std::string& text) {
    return keys_in_file(parse_toml(text, "s.toml"));
  };
  EXPECT_EQ(kept("[render]\nmax_bounces = 3\n"), KeptKeys{});
  EXPECT_EQ(kept("[render]\nmethod = \"auto\"\nmax_direction_error_mrad = 1\n"),
            (KeptKeys{.method = true, .max_direction_error = true}));
  EXPECT_EQ(kept("[render]\nrays_per_axis = 1\n[render.paths]\nsamples = 4\n"),
            (KeptKeys{.rays_per_axis = true, .samples = true}));
}

TEST(AtRung, TouchesNothingThatAnotherLevelUses) {
  const auto of_paths = render_ladder(rough(), {});
  const SceneSettings scene = at_rung(mirror(), of_paths.front());
  EXPECT_EQ(scene.paths.samples, mirror().paths.samples);
  EXPECT_EQ(scene.render.max_direction_error_rad, mirror().render.max_direction_error_rad);
}

// 0.5 Mpx: sums at 4 rays a pixel, one frame that is scored: 0.5 * (2.5 + 1.4 * 4 + 0.5) = 4.3.
TEST(CountedWork, OfDirectSumsGrowsWithTheirRaysAndNotWithSamples) {
  SceneSettings scene = steel();
  scene.render.method = Method::kDirect;
  EXPECT_DOUBLE_EQ(counted_work(scene), 4.3);
  scene.paths.samples = 1024;
  EXPECT_DOUBLE_EQ(counted_work(scene), 4.3);
}

// Teeth shade each other, so that each place on a lamp is asked for: 0.5 * (25 * 4^1.5 + 0.5). More
// than 128 samples of paths, which are asked for one place each.
TEST(CountedWork, OfDirectSumsIsLargeWhereThePartShadesItself) {
  SceneSettings scene = steel();
  scene.part.shape = PartSettings::Shape::kSpurGear;
  scene.paths.samples = 128;
  scene.paths.max_reflections = 1;
  const double by_paths = counted_work(scene);
  scene.render.method = Method::kDirect;
  EXPECT_DOUBLE_EQ(counted_work(scene), 100.25);
  EXPECT_GT(counted_work(scene), by_paths);
}

TEST(CountedWork, OfDirectSumsIsLargeForHollowStrips) {
  SceneSettings scene = steel();
  scene.render.method = Method::kDirect;
  scene.part.radius_across_mm = -80.0;
  EXPECT_DOUBLE_EQ(counted_work(scene), 100.25) << "as of a gear";
  scene.part.radius_across_mm = 0.0;
  EXPECT_DOUBLE_EQ(counted_work(scene), 4.3) << "straight";
}

TEST(RenderLadder, OfAGearHasNoDirectSumsThatTakeMoreThanItsTop) {
  SceneSettings gear = steel();
  gear.part.shape = PartSettings::Shape::kSpurGear;
  EXPECT_THAT(direct_sums(render_ladder(gear, {})), ElementsAre("direct sum, 1 ray a pixel"));
}

// 0.5 Mpx: 16 samples with direct light, one frame of a scan of 10 scored in itself and without
// each of 4 batches: 0.5 * (16 + 0.5 * 10 * 5) = 20.5.
TEST(CountedWork, IsPathsAndScoring) {
  SceneSettings scene = rough();
  scene.paths.samples = 16;
  scene.paths.max_reflections = 1;
  scene.paths.batches = 4;
  EXPECT_DOUBLE_EQ(counted_work(scene), 20.5);
  // The second reflection: half the paths go on, at half the price.
  scene.paths.max_reflections = 2;
  EXPECT_DOUBLE_EQ(counted_work(scene), 0.5 * (16 * 1.25 + 25.0));
}

TEST(CountedWork, GrowsWithPixelsSamplesAndReflections) {
  const SceneSettings scene = rough();
  SceneSettings more = scene;
  more.camera.width_px *= 2;
  EXPECT_DOUBLE_EQ(counted_work(more), 2.0 * counted_work(scene));
  more = scene;
  ++more.paths.max_reflections;
  EXPECT_GT(counted_work(more), counted_work(scene));
}

}  // namespace
}  // namespace glint
