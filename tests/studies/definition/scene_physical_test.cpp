// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "studies/definition/scene.h"
#include "studies/definition/scene_viewpoints.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kRingScene = R"(
[part]
shape = "plate"
[material]
type = "conductor"
colour_srgb = [196, 199, 199]
roughness = 0.25
anisotropy = 0.7
[lens]
focus_mm = 146
f_number = 4
[camera]
focal_mm = 12
object_pixel_mm = 0
working_distance_mm = 146
[sensor]
wavelengths_nm = [630, 532, 465]
[[viewpoint]]
position_mm = [0, 0, 146]
[[viewpoint]]
position_mm = [30, 0, 140]
direction = [-30, 0, -140]
[lighting.ring]
mount = "camera"
segments = 4
segment_power = [1, 0.5, 0, 1]
[lighting.left]
type = "bar"
length_mm = 120
[render.paths]
samples = 32
max_reflections = 2
)";

SceneSettings physical_scene(const std::string& text, std::vector<Problem>& errors) {
  return read_scene(parse_toml(text, "scene.toml"), errors);
}

std::vector<std::string> errors_of(const std::string& text) {
  std::vector<Problem> errors;
  physical_scene(text, errors);
  return messages_of(errors);
}

TEST(PhysicalScene, ReadsMaterialLensLightsAndViewpoints) {
  std::vector<Problem> errors;
  const SceneSettings scene = physical_scene(kRingScene, errors);
  EXPECT_THAT(errors, ElementsAre());
  EXPECT_TRUE(needs_paths(scene));
  EXPECT_FALSE(scene.has_tunnel);
  ASSERT_EQ(scene.lights.size(), 2U);
  EXPECT_EQ(light_type(scene.lights[0].settings), "ring");
  EXPECT_EQ(scene.lights[1].name, "left");
  EXPECT_EQ(std::get<BarSettings>(scene.lights[1].settings).length_mm, 120.0);
  EXPECT_EQ(scene.viewpoints.size(), 2U);
  EXPECT_EQ(scene.viewpoints[1].position_mm[0], 30.0);
  EXPECT_EQ(scene.paths.channels, 3);
  EXPECT_EQ(scene.paths.samples, 32);
  // 1 / 12 = 1 / 146 + 1 / v: v = 13.0746 mm; over pixels of 5.5 um: 2377.2 px.
  EXPECT_NEAR(intrinsics_of(scene).focal_px.x(), 2377.2, 0.1);
}

TEST(PhysicalScene, WritingAndReadingBackGivesTheSameScene) {
  std::vector<Problem> errors;
  const ConfigNode written = write_scene(physical_scene(kRingScene, errors));
  const ConfigNode again = write_scene(physical_scene(to_toml(written), errors));
  EXPECT_THAT(errors, ElementsAre());
  EXPECT_EQ(to_toml(written), to_toml(again));
  ASSERT_NE(again.at_path("lighting.ring.segment_power.1"), nullptr);
  EXPECT_EQ(again.at_path("lighting.ring.segment_power.1")->number, 0.5);
  EXPECT_EQ(again.at_path("viewpoint.1.position_mm.0")->number, 30.0);
}

TEST(NeedsPaths, OnlyBeyondAPlainMirrorUnderOneTunnel) {
  const auto needs = [](const std::string& text) {
    std::vector<Problem> errors;
    const SceneSettings scene = physical_scene(text, errors);
    EXPECT_THAT(errors, ElementsAre()) << text;
    return needs_paths(scene);
  };
  EXPECT_FALSE(needs(""));
  EXPECT_FALSE(needs("[lighting.tunnel]\n"));
  EXPECT_FALSE(needs("[material]\nreflectance = [0.8]\n"));
  EXPECT_TRUE(needs("[render]\nmethod = \"paths\"\n"));
  EXPECT_TRUE(needs("[material]\ntype = \"conductor\"\n"));
  EXPECT_TRUE(needs("[material]\nreflectance = [0.9, 0.8, 0.7]\n"));
  EXPECT_TRUE(needs("[material.coat]\nindex = 1.5\n"));
  EXPECT_TRUE(needs("[lighting.dome]\n"));
  EXPECT_TRUE(needs("[lighting.tunnel]\n[lighting.bar]\n"));
}

TEST(Scene, OfLevelZeroTakesTheReflectanceOfItsMaterial) {
  std::vector<Problem> errors;
  EXPECT_EQ(physical_scene("[material]\nreflectance = [0.8]\n", errors).render.reflectance, 0.8);
}

TEST(Scene, WhatDoesNotGoTogetherIsToldWithItsPlace) {
  EXPECT_THAT(errors_of("[lighting.lamp]\ntype = \"torch\"\n"),
              ElementsAre(HasSubstr("scene.toml:2:1: lighting.lamp.type: is \"torch\"")));
  EXPECT_THAT(errors_of("[lighting]\nring = 3\n"),
              ElementsAre(HasSubstr("lighting: must hold a table for each light")));
  EXPECT_THAT(errors_of("[render]\nmethod = \"closed\"\n[lighting.ring]\n"),
              ElementsAre(HasSubstr("scene.toml:2:1: render.method: is \"closed\"")));
  EXPECT_THAT(errors_of("[[viewpoint]]\n[[viewpoint]]\n"),
              ElementsAre(HasSubstr("viewpoint: a scan has exactly one")));
  EXPECT_THAT(errors_of("[viewpoints]\nsource = \"sphere\"\n"),
              ElementsAre(HasSubstr("viewpoints.source: a scan has the one")));
  EXPECT_THAT(errors_of("[lighting.ring]\nradius_mm = 3\n"),
              ElementsAre(HasSubstr("scene.toml:2:1: lighting.ring.radius_mm: unknown key")));
  EXPECT_THAT(errors_of("[sensor]\nwavelengths_nm = [500, 600]\n"),
              ElementsAre(HasSubstr("sensor.wavelengths_nm: has 2 numbers")));
}

// A ring whose name is no kind is taken for a tunnel, which has none of its keys.
TEST(Scene, SaysThatALightWithoutTypeIsReadAsATunnel) {
  EXPECT_THAT(errors_of("[lighting.left_ring]\ninner_radius_mm = 30\n"),
              ElementsAre(AllOf(HasSubstr("scene.toml:2:1: lighting.left_ring.inner_radius_mm: "
                                          "unknown key"),
                                HasSubstr("no type, so it is read as a tunnel"))));
  for (const char* order :
       {"[lighting.tunnel]\n[lighting.left_ring]\n", "[lighting.left_ring]\n[lighting.tunnel]\n"}) {
    EXPECT_THAT(errors_of(order),
                ElementsAre(AllOf(HasSubstr("is a second tunnel"),
                                  HasSubstr("no type, so it is read as a tunnel"))))
        << order;
  }
  EXPECT_THAT(errors_of("[lighting.tunnel]\ninner_radius_mm = 30\n"),
              ElementsAre(Not(HasSubstr("no type"))));
  EXPECT_THAT(errors_of("[lighting.left_ring]\ntype = \"ring\"\nradius_mm = 30\n"),
              ElementsAre(Not(HasSubstr("no type"))));
}

TEST(ViewpointsOf, AlongTheSurfaceStandAtTheWorkingDistanceApartFromEachOther) {
  std::vector<Problem> errors;
  const SceneSettings scene = physical_scene(R"(
[part]
shape = "sphere_cap"
radius_mm = 25
height_mm = 50
[camera]
working_distance_mm = 120
[viewpoints]
source = "surface"
count = 12
[lighting.ring]
)",
                                             errors);
  ASSERT_THAT(errors, ElementsAre());
  const Part part = build_part(scene.part);
  const std::vector<Viewpoint> views = viewpoints_of(scene, part);
  ASSERT_EQ(views.size(), 12U);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Eigen::Vector3d at = Eigen::Map<const Eigen::Vector3d>(views[i].position_mm.data());
    EXPECT_NEAR(at.norm(), 145.0, 0.1);  // radius + working distance
    for (std::size_t k = 0; k < i; ++k) {
      const Eigen::Vector3d other = Eigen::Map<const Eigen::Vector3d>(views[k].position_mm.data());
      EXPECT_GT((at - other).norm(), 40.0);
    }
  }
}

}  // namespace
}  // namespace glint
