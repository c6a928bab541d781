// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/searched/searched_scene.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/units.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/scene_picture.h"
#include "studies/inspection_line/simulated_line.h"
#include "tests/studies/imaging/direct/lamp_scene.h"

namespace glint::lamp_test {
namespace {

/// A ring of four sectors, flat or as a steep cone narrower than the plate: from the plate's ends
/// its near side stands before its far one.
SceneSettings sectors(double tilt_deg) {
  SceneSettings scene = lamp_scene(R"([lighting.ring]
inner_radius_mm = 2
outer_radius_mm = 6
height_mm = 10
segments = 4
separate_segments = true
)",
                                   "alpha = [0.2]\n",
                                   "");
  std::get<RingSettings>(scene.lights[0].settings).tilt_rad = tilt_deg * kPi / 180.0;
  return scene;
}

RenderRung rung_of(const std::string& level) {
  const std::vector<RenderRung> ladder = render_ladder(sectors(0.0), {});
  return *std::ranges::find(ladder, level, &RenderRung::level);
}

TEST(SearchedScene, IsSummedWhereLampsHideNothing) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = searched_scene(store, sectors(0.0), rung_of("direct sum"), {});
  EXPECT_EQ(scene.render.method, RenderSettings::Method::kDirect);
}

// What would be refused follows paths, as many as the ladder's scene has, and can be rendered.
TEST(SearchedScene, FollowsPathsWhereALampMayHideItself) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const RenderRung rung = rung_of("direct sum");
  const SceneSettings cone = sectors(75.0);
  EXPECT_THROW(picture_of(store, at_rung(cone, rung)), ConfigError) << "sums are refused";
  const SceneSettings scene = searched_scene(store, cone, rung, {});
  EXPECT_EQ(scene.render.method, RenderSettings::Method::kAuto);
  EXPECT_EQ(scene.paths.samples, rung.paths.samples);
  EXPECT_TRUE(picture_of(store, scene)->mean({}).aspect.values().size() > 0);
}

TEST(SearchedScene, OfOtherRungsIsWhatTheRungSays) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const RenderRung rung = rung_of("direct light");
  const SceneSettings scene = searched_scene(store, sectors(75.0), rung, {});
  EXPECT_EQ(scene.render.method, RenderSettings::Method::kAuto);
  EXPECT_EQ(scene.paths.samples, rung.paths.samples);
}

// A file that asks for sums gets them, or is refused.
TEST(SearchedScene, LeavesWhatTheFileAsksFor) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings cone = sectors(75.0);
  cone.render.method = RenderSettings::Method::kDirect;
  const SceneSettings scene = searched_scene(store, cone, rung_of("direct sum"), {});
  EXPECT_EQ(scene.render.method, RenderSettings::Method::kDirect);
}

/// Half as many pixels a side, whose h is 0.25 too high.
RenderRung half_resolution(int samples) {
  return {.paths = {.samples = samples, .max_reflections = 1},
          .pixel_factor = 2,
          .offsets = {{"homogeneity.h_rms", 0.25}}};
}

/// A ring over a dent of 0.3 mm in the middle of a pixel of 0.3 mm, whose background lies between
/// 0.3 and 0.435 mm: 0.42 mm along the diagonal is another pixel's middle. Pixels of 0.6 mm have
/// theirs at 0.21 and 0.47 mm.
SceneSettings with_small_dent() {
  SceneSettings scene = by_paths(sectors(0.0));
  DefectGroup& dent = scene.defects.front().second;
  dent.x_mm = {0.15};
  dent.y_mm = {0.15};
  dent.diameter_mm = 0.3;
  dent.height_mm = 1e-3;
  scene.metrics.ring_outer_radii = 2.9;
  return scene;
}

TEST(SearchedScene, TakesAllPixelsWhereLargerOnesLeaveADefectNoBackground) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = with_small_dent();
  const RenderRung rung = half_resolution(32);
  ASSERT_NO_THROW(store.trace(scene));
  EXPECT_THROW(store.trace(at_rung(scene, rung)), ConfigError);
  const SceneSettings searched = searched_scene(store, scene, rung, {});
  EXPECT_EQ(searched.camera.width_px, scene.camera.width_px);
  EXPECT_EQ(searched.paths.samples, 128) << "the scene's own";
  EXPECT_EQ(searched_scene(store, scene, half_resolution(256), {}).paths.samples, 256);
  std::map<std::string, double> scores = {{"homogeneity.h_rms", 0.5}};
  less_offsets(scene, searched, rung, scores);
  EXPECT_EQ(scores.at("homogeneity.h_rms"), 0.5) << "mean errors are those of half resolution";
}

/// 8 rows of whole pixels, of which a rim of 3 leaves 2; of pixels twice as large 3 rows, which a
/// rim of 2 takes all of.
SceneSettings narrow_plate() {
  SceneSettings scene = by_paths(sectors(0.0));
  scene.part.width_mm = 2.4;
  scene.defects.clear();
  scene.inspection.erosion_px = 3;
  return scene;
}

TEST(SearchedScene, TakesAllPixelsWhereLargerOnesAreAllRimToTheInspector) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = narrow_plate();
  const RenderRung rung = half_resolution(32);
  const SceneSettings half = at_rung(scene, rung);
  ASSERT_NO_THROW(store.trace(half)) << "its picture has a region";
  ASSERT_NO_THROW(check_inspected_region(store, scene));
  EXPECT_THAT([&] { check_inspected_region(store, half); },
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr("inspection.erosion_px")));
  const std::vector<std::string> of_line = {"inspection.false_alarms"};
  EXPECT_EQ(searched_scene(store, scene, rung, of_line).camera.width_px, scene.camera.width_px);
  const std::vector<std::string> of_scans = {"homogeneity.h_rms.low"};
  EXPECT_EQ(searched_scene(store, scene, rung, of_scans).camera.width_px, half.camera.width_px)
      << "nothing is inspected";
}

// As a search evaluates a design.
TEST(SearchedScene, IsInspectedWhereHalfResolutionWouldFail) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings scene = narrow_plate();
  scene.inspection.trials.flawless = 2;
  const RenderRung rung = half_resolution(8);
  const WantedScores wanted = {.trials = {"inspection.false_alarms"}};
  EXPECT_THROW(evaluate(store, at_rung(scene, rung), {}, wanted), ConfigError);
  const SceneSettings searched = searched_scene(store, scene, rung, wanted.trials);
  EXPECT_TRUE(evaluate(store, searched, {}, wanted).scores.contains("inspection.false_alarms"));
}

TEST(SearchedScene, OfHalfResolutionIsCorrectedWhereItCanBeScored) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = by_paths(sectors(0.0));
  const RenderRung rung = half_resolution(32);
  const SceneSettings searched = searched_scene(store, scene, rung, {});
  EXPECT_EQ(searched.camera.width_px, scene.camera.width_px / 2);
  EXPECT_EQ(searched.paths.samples, 32);
  std::map<std::string, double> scores = {{"homogeneity.h_rms", 0.5}};
  less_offsets(scene, searched, rung, scores);
  EXPECT_EQ(scores.at("homogeneity.h_rms"), 0.25);
}

}  // namespace
}  // namespace glint::lamp_test
