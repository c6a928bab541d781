// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene_notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "studies/definition/render_methods.h"

namespace glint {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

SceneSettings lit_by(std::vector<NamedLight> lights) {
  SceneSettings scene;
  scene.has_tunnel = false;
  scene.lights = std::move(lights);
  return scene;
}

std::vector<std::string> texts_of_scene(const SceneSettings& scene, const Scores& scores) {
  return note_texts(scene_notes(scene, scores));
}

TEST(LightLines, TellTypeSizeAndPlaceOfEachLight) {
  RingSettings ring;
  ring.placement.mount = LightPlacement::Mount::kCamera;
  ring.tilt_rad = 30.0 * kRadPerDeg;
  SceneSettings scene = lit_by(
      {{.name = "upper", .settings = ring}, {.name = "sky", .settings = EnvironmentSettings{}}});
  EXPECT_THAT(light_lines(scene),
              ElementsAre("upper: ring, radii 25 to 40 mm, tilted by 30\u00b0, on the camera",
                          "sky: environment, the same from everywhere"));
  EXPECT_THAT(light_titles(scene), ElementsAre("upper: ring", "sky: environment"));
  scene.has_tunnel = true;
  scene.tunnel_name = "arch";
  EXPECT_EQ(light_titles(scene).front(), "arch: tunnel");
  EXPECT_EQ(
      light_lines(scene).front(),
      "arch: tunnel, semicylinder, 200 mm wide, up to 100 mm above the origin, 600 mm long, slot "
      "20 mm, stripes of period 16 mm, bright share 0.5");
  scene.tunnel_name = "tunnel";
  EXPECT_EQ(light_lines(scene).front().rfind("tunnel, semicylinder", 0), 0U);
}

TEST(LightLines, ATitleIsWholeWithACommaInTheName) {
  const SceneSettings scene = lit_by({{.name = "left, low", .settings = RingSettings{}},
                                      {.name = "ring", .settings = RingSettings{}}});
  EXPECT_THAT(light_titles(scene), ElementsAre("left, low: ring", "ring"));
}

// The lobes of rough metal see slot and ends: its mean is uneven without any clipping.
TEST(SceneNotes, PromiseNoEvenMeanOfRoughMetal) {
  SceneSettings scene;
  EXPECT_THAT(texts_of_scene(scene, {}), Contains(HasSubstr("the mean of a linear sensor")));
  scene.material.type = MaterialSettings::Type::kConductor;
  scene.material.alpha = {0.05};
  scene.render.method = RenderSettings::Method::kBlurred;
  EXPECT_THAT(texts_of_scene(scene, {}), Not(Contains(HasSubstr("the mean of a linear sensor"))));
  EXPECT_THAT(method_notes(scene), Contains(HasSubstr("blurred reflections")));
}

TEST(SceneNotes, TellThatASmoothMirrorShowsTheLightsAlone) {
  const auto has_note = Contains(HasSubstr("is a mirror without roughness"));
  SceneSettings scene = lit_by({{.name = "ring", .settings = RingSettings{}}});
  EXPECT_THAT(texts_of_scene(scene, {}), has_note);
  scene.material.type = MaterialSettings::Type::kConductor;
  EXPECT_THAT(texts_of_scene(scene, {}), Not(has_note));
  scene.material.roughness = 0.0;
  EXPECT_THAT(texts_of_scene(scene, {}), has_note);
  scene.material.alpha = {0.3};
  EXPECT_THAT(texts_of_scene(scene, {}), Not(has_note));
  scene.material = {};
  scene.lights.push_back({.name = "sky", .settings = EnvironmentSettings{}});
  EXPECT_THAT(texts_of_scene(scene, {}), Not(has_note))
      << "it reflects the surroundings everywhere";
  EXPECT_THAT(texts_of_scene(SceneSettings{}, {}), Not(has_note)) << "a tunnel is made for it";
}

TEST(SceneNotes, TellThatALightOnThePartMovesWithItsPose) {
  BarSettings bar;
  bar.placement.mount = LightPlacement::Mount::kPart;
  SceneSettings scene = lit_by({{.name = "bar", .settings = bar}});
  const auto has_note = Contains(HasSubstr("lighting.bar.mount is \"part\""));
  EXPECT_THAT(texts_of_scene(scene, {}), Not(has_note)) << "the part stands where it always stood";
  scene.part.position_mm = {0.0, 0.0, -20.0};
  EXPECT_THAT(texts_of_scene(scene, {}), has_note);
  scene.part.position_mm = {0.0, 0.0, 0.0};
  scene.part.rotation_rad = {0.0, 0.1, 0.0};
  EXPECT_THAT(texts_of_scene(scene, {}), has_note);
  scene.lights.front().settings = BarSettings{};
  EXPECT_THAT(texts_of_scene(scene, {}), Not(has_note)) << "it stays in the scene, as before";
}

TEST(SceneNotes, TellThatALightWithoutTypeIsReadAsATunnel) {
  SceneSettings scene;
  scene.tunnel_name = "left_ring";
  const auto has_note =
      Contains(HasSubstr("[lighting.left_ring] has no type, so it is read as a "
                         "tunnel"));
  EXPECT_THAT(texts_of_scene(scene, {}), Not(has_note));
  scene.is_tunnel_guessed = true;
  EXPECT_THAT(texts_of_scene(scene, {}), has_note);
}

// 24 positions over one period at duty 0.5 are 12 bright ones; 25 positions are 12.5.
TEST(SceneNotes, TellWhetherAScanHasWholeBrightPositions) {
  SceneSettings scene;
  scene.scan.positions = 24;
  scene.tunnel.duty = 0.5;
  EXPECT_THAT(texts_of_scene(scene, {}),
              ElementsAre(HasSubstr("24 positions x duty 0.5 is a whole number")));
  scene.scan.positions = 25;
  EXPECT_THAT(texts_of_scene(scene, {}),
              ElementsAre(HasSubstr("25 positions x duty 0.5 over 1 period "
                                    "is not a whole number")));
}

// The default scene has 1300 x 300 pixels of 0.15 mm, stripes of 16 mm and a blur of 0.7 px.
TEST(SceneNotes, WarnOfWhatStabilityFoundAndOfNothingElse) {
  SceneSettings scene;
  EXPECT_EQ(texts_of_scene(scene, {{"homogeneity.clipped_share", 0.04}}).size(), 1U);
  EXPECT_THAT(texts_of_scene(scene, {{"homogeneity.clipped_share", 0.5}}),
              Contains(HasSubstr("50 % of the region is at full scale in every frame")));
  scene.sensor.blur_px = 25.0;  // 0.08 * 300 px = 24
  EXPECT_THAT(texts_of_scene(scene, {}), Contains(HasSubstr("A blur of 25 px is wide")));
  scene.sensor.blur_px = 23.0;
  EXPECT_EQ(texts_of_scene(scene, {}).size(), 1U);
  scene.tunnel.period_mm = 0.5;  // 3.3 pixels
  EXPECT_THAT(texts_of_scene(scene, {}), Contains(HasSubstr("is 3.3 pixels on the part")));
  scene.tunnel.period_mm = 16.0;
  scene.sensor.full_well_e = 100.0;  // sqrt(0.5 / 100) = 7.1 %
  EXPECT_EQ(texts_of_scene(scene, {}).size(), 1U) << "there is no defect whose change holds it";
  scene.defects = {{"dent", DefectGroup{}}};
  EXPECT_THAT(texts_of_scene(scene, {}), Contains(HasSubstr("Noise of a frame is 7.1 %")));
  scene.sensor.full_well_e = 1000.0;  // 2.2 %
  EXPECT_EQ(texts_of_scene(scene, {}).size(), 1U);
}

// 0.5 % of 16 mm are 0.53 pixels of 0.15 mm.
TEST(SceneNotes, WarnOfStripesNarrowerThanAPixel) {
  const auto has_note = Contains(HasSubstr("stripes are 0.53 pixels wide on the part"));
  SceneSettings scene;
  scene.tunnel.duty = 0.005;
  EXPECT_THAT(texts_of_scene(scene, {}), has_note);
  scene.tunnel.duty = 0.995;
  EXPECT_THAT(texts_of_scene(scene, {}), Contains(HasSubstr("The dark stripes are 0.53 pixels")));
  for (const double duty : {0.0, 0.01, 0.99, 1.0}) {
    scene.tunnel.duty = duty;
    EXPECT_THAT(texts_of_scene(scene, {}), Not(Contains(HasSubstr("pixels wide")))) << duty;
  }
}

TEST(SceneNotes, ListTheLightsOfAPathTracedSceneAndSayWhenItIsDark) {
  const SceneSettings scene = lit_by({{.name = "ring", .settings = RingSettings{}}});
  const auto notes = texts_of_scene(scene, {{"homogeneity.mean", 0.0}});
  EXPECT_THAT(notes.front(), HasSubstr("Light ring, radii 25 to 40 mm"));
  EXPECT_THAT(notes, Contains(HasSubstr("No light reaches the part")));
  EXPECT_THAT(texts_of_scene(scene, {{"homogeneity.mean", 0.1}}),
              Not(Contains(HasSubstr("No light reaches the part"))));
}

TEST(MethodNotes, TellWhatRescoringLooksAt) {
  SceneSettings scene;
  scene.render.rays_per_axis = 3;
  EXPECT_THAT(method_notes(scene).back(), HasSubstr("directions four times as accurate"));
  scene.render.method = RenderSettings::Method::kSampled;
  EXPECT_THAT(method_notes(scene).front(), HasSubstr("perfect mirror, 9 rays per pixel traced"));
  EXPECT_THAT(method_notes(scene).back(), HasSubstr("fresh noise and 36 rays per pixel."));
  scene.render.method = RenderSettings::Method::kPaths;
  EXPECT_THAT(method_notes(scene).front(), HasSubstr("path tracing with"));
}

TEST(SceneNotes, TellWhereTooManyRaysWereSaved) {
  const auto has_note = ::testing::Contains(::testing::HasSubstr("at most 4 x 4 cells"));
  EXPECT_THAT(texts_of_scene(SceneSettings(), {}), ::testing::Not(has_note));
  EXPECT_THAT(texts_of_scene(SceneSettings(), {{"rays.max_cells", 4.0}}), has_note);
}

}  // namespace
}  // namespace glint
