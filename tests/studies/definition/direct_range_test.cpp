// SPDX-License-Identifier: GPL-3.0-or-later
//
// What render.method = "direct" takes and refuses, with the places of keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "studies/definition/render_methods.h"

namespace glint::direct_range_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::StartsWith;

using Method = RenderSettings::Method;

const std::string kRender = "[render]\nmethod = \"direct\"\n";
const std::string kMetal = "[material]\ntype = \"conductor\"\n";
const std::string kRing = "[lighting.ring]\n";

std::vector<std::string> errors_of(const std::string& text) {
  std::vector<Problem> errors;
  read_scene(parse_toml(text, "s.toml"), errors);
  return messages_of(errors);
}

/// Lines 1 to 4 hold the method and the metal.
std::vector<std::string> errors_of_metal(const std::string& text) {
  return errors_of(kRender + kMetal + text);
}

SceneSettings steel() {
  SceneSettings scene;
  scene.has_tunnel = false;
  scene.lights = {{.name = "ring", .settings = RingSettings{}}};
  scene.material.type = MaterialSettings::Type::kConductor;
  scene.material.alpha = {0.2};
  scene.render.method = Method::kDirect;
  return scene;
}

TEST(DirectRange, IsReachedFromAFile) {
  for (const char* width : {"alpha = [0.05]\n",
                            "alpha = [0.3, 0.1]\n",
                            "roughness = 1\n",
                            "roughness = 0.4\nanisotropy = -0.7\n"}) {
    EXPECT_THAT(errors_of_metal(width + kRing), IsEmpty()) << width;
  }
  for (const char* type : {"ring", "dome", "bar", "coaxial"}) {
    EXPECT_THAT(errors_of_metal("[lighting.lamp]\ntype = \"" + std::string(type) + "\"\n"),
                IsEmpty())
        << type;
  }
  EXPECT_THAT(errors_of_metal(kRing + "[[viewpoint]]\n[[viewpoint]]\n"), IsEmpty())
      << "as many views as by paths";
}

TEST(DirectRange, RefusesNarrowLobesAtTheirPlaces) {
  EXPECT_THAT(errors_of_metal("alpha = [0.049]\n" + kRing),
              ElementsAre(AllOf(StartsWith("s.toml:5:"),
                                HasSubstr("material.alpha: makes a width of 0.049"),
                                HasSubstr("allowed are widths from 0.05"),
                                HasSubstr("or render.method = \"paths\""))));
  EXPECT_THAT(errors_of_metal("alpha = [0.2, 0.01]\n" + kRing),
              ElementsAre(HasSubstr("a width of 0.01")));
  EXPECT_THAT(
      errors_of_metal("roughness = 0.2\n" + kRing),
      ElementsAre(AllOf(StartsWith("s.toml:5:"), HasSubstr("material.roughness: makes a width"))));
}

TEST(DirectRange, RefusesOtherMaterials) {
  EXPECT_THAT(errors_of(kRender + kRing), ElementsAre(HasSubstr("material.type: is \"mirror\"")));
  EXPECT_THAT(errors_of(kRender + "[material]\ntype = \"diffuse\"\n" + kRing),
              ElementsAre(AllOf(StartsWith("s.toml:4:"), HasSubstr("allowed is \"conductor\""))));
  EXPECT_THAT(errors_of_metal("[material.coat]\nindex = 1.5\n" + kRing),
              ElementsAre(AllOf(StartsWith("s.toml:6:"), HasSubstr("material.coat.index"))));
  EXPECT_THAT(
      errors_of_metal("[material.pattern]\nkind = \"concentric\"\nroughness = 0.1\n" + kRing),
      ElementsAre(AllOf(StartsWith("s.toml:7:"), HasSubstr("material.pattern.roughness"))));
  EXPECT_THAT(errors_of_metal("[material.pattern]\nkind = \"concentric\"\n" + kRing), IsEmpty())
      << "colours alone";
  EXPECT_THAT(errors_of_metal("[defects.stain]\nstain_roughness_deg = 2\n" + kRing),
              ElementsAre(AllOf(StartsWith("s.toml:6:"), HasSubstr("stain_roughness_deg"))));
}

TEST(DirectRange, RefusesOtherLight) {
  EXPECT_THAT(errors_of_metal("[lighting.wall]\ntype = \"tunnel\"\n"),
              ElementsAre(AllOf(StartsWith("s.toml:5:"), HasSubstr("lighting.wall: is a tunnel"))));
  EXPECT_THAT(
      errors_of_metal(kRing + "[lighting.sky]\ntype = \"environment\"\n"),
      ElementsAre(AllOf(StartsWith("s.toml:6:"), HasSubstr("lighting.sky: is an environment"))));
  SceneSettings measured = steel();
  measured.lights.push_back({.name = "spot", .settings = IesLightSettings{}});
  const std::vector<Problem> problems = direct_problems(measured);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].key, "lighting.spot");
  EXPECT_THAT(problems[0].text, StartsWith("is measured"));
}

TEST(DirectRange, RefusesOtherCamerasAndTooManyRays) {
  EXPECT_THAT(errors_of_metal(kRing + "[lens]\nfocus_mm = 300\nf_number = 4\n[camera]\nfocal_mm = "
                                      "12\nobject_pixel_mm = 0\n"),
              ElementsAre(AllOf(StartsWith("s.toml:8:"), HasSubstr("lens.f_number: is 4"))));
  EXPECT_THAT(errors_of("[render]\nmethod = \"direct\"\nrays_per_axis = 5\n" + kMetal + kRing),
              ElementsAre(AllOf(StartsWith("s.toml:3:"),
                                HasSubstr("render.rays_per_axis: is 5"),
                                HasSubstr("allowed are 1 to 4"))));
}

TEST(DirectRange, IsAskedForAndNotChosen) {
  SceneSettings scene = steel();
  EXPECT_TRUE(needs_paths(scene)) << "views and lights are those of paths";
  scene.render.method = Method::kAuto;
  scene.render.rays_per_axis = 16;
  EXPECT_FALSE(is_direct(scene));
  EXPECT_THAT(direct_problems(scene), IsEmpty());
}

TEST(DirectRange, HasItsOwnFramesAndItsFinerOnesHaveMoreRays) {
  SceneSettings scene = steel();
  EXPECT_EQ(frame_method(scene).name, "direct");
  EXPECT_THAT(frame_method(scene).numbers, ElementsAre(Pair("rays_per_axis", 2)));
  EXPECT_EQ(rescoring_settings(scene).render.rays_per_axis, 4);
  EXPECT_EQ(rescoring_settings(scene).render.method, Method::kDirect);
  EXPECT_EQ(rescoring_settings(scene).paths.samples, scene.paths.samples);
  EXPECT_NE(rescoring_settings(scene).sensor.seed, scene.sensor.seed);
  scene.render.rays_per_axis = 4;
  EXPECT_EQ(rescoring_settings(scene).render.rays_per_axis, 4) << "the most there are";
}

TEST(DirectRange, RepeatsTheNoiseOfTheSensorAlone) {
  const SceneSettings scene = steel();
  EXPECT_EQ(repeated_settings(scene, 3).paths.seed, scene.paths.seed) << "its picture is kept";
  EXPECT_NE(repeated_settings(scene, 3).sensor.seed, scene.sensor.seed);
}

}  // namespace
}  // namespace glint::direct_range_test
