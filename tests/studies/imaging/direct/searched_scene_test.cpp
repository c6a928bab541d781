// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/searched/searched_scene.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/units.h"
#include "studies/imaging/scene_picture.h"
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
  const SceneSettings scene = searched_scene(store, sectors(0.0), rung_of("direct sum"));
  EXPECT_EQ(scene.render.method, RenderSettings::Method::kDirect);
}

// What would be refused follows paths, as many as the ladder's scene has, and can be rendered.
TEST(SearchedScene, FollowsPathsWhereALampMayHideItself) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const RenderRung rung = rung_of("direct sum");
  const SceneSettings cone = sectors(75.0);
  EXPECT_THROW(picture_of(store, at_rung(cone, rung)), ConfigError) << "sums are refused";
  const SceneSettings scene = searched_scene(store, cone, rung);
  EXPECT_EQ(scene.render.method, RenderSettings::Method::kAuto);
  EXPECT_EQ(scene.paths.samples, rung.paths.samples);
  EXPECT_TRUE(picture_of(store, scene)->mean({}).aspect.values().size() > 0);
}

TEST(SearchedScene, OfOtherRungsIsWhatTheRungSays) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const RenderRung rung = rung_of("direct light");
  const SceneSettings scene = searched_scene(store, sectors(75.0), rung);
  EXPECT_EQ(scene.render.method, RenderSettings::Method::kAuto);
  EXPECT_EQ(scene.paths.samples, rung.paths.samples);
}

// A file that asks for sums gets them, or is refused.
TEST(SearchedScene, LeavesWhatTheFileAsksFor) {
  ThreadPool pool(2);
  SceneStore store(pool);
  SceneSettings cone = sectors(75.0);
  cone.render.method = RenderSettings::Method::kDirect;
  const SceneSettings scene = searched_scene(store, cone, rung_of("direct sum"));
  EXPECT_EQ(scene.render.method, RenderSettings::Method::kDirect);
}

}  // namespace
}  // namespace glint::lamp_test
