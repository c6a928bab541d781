// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "studies/definition/scene.h"
#include "studies/definition/scene_lights.h"
#include "studies/definition/study.h"
#include "studies/definition/study_text.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

constexpr const char* kLights = R"([lighting.tunnel]
radius_mm = 120
[lighting.ring]
[lighting.dome]
)";

Study lighting_study(const std::string& text, const std::vector<KeyValue>& sets = {}) {
  const TemporaryFolder folder;
  write_file(folder / "s.toml", text);
  return load_study(folder / "s.toml", sets);
}

std::string lighting_error(const std::string& text) {
  try {
    lighting_study(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

const std::string kSearch = R"([variables]
"lighting_use" = { choices = ["tunnel", "ring", "ring+dome"] }
"lighting.tunnel.radius_mm" = { min = 90, max = 150, when = "lighting_use == tunnel" }
"lighting.ring.height_mm" = { min = 40, max = 90, when = "lighting_use in [ring, ring+dome]" }
[objective]
maximise = "homogeneity.h_rms"
[budget]
evaluations = 10
)";

TEST(LightingUse, AllLightsShineUnlessItSaysOtherwise) {
  const SceneSettings scene = lighting_study(kLights).scene;
  EXPECT_TRUE(scene.has_tunnel);
  EXPECT_EQ(scene.lights.size(), 2U);
  EXPECT_TRUE(scene.idle_lights.empty());
  EXPECT_TRUE(needs_paths(scene));
}

TEST(LightingUse, IdleLightsDoNotDecideTheTransport) {
  const SceneSettings scene =
      lighting_study("lighting_use = \"tunnel\"\n" + std::string(kLights)).scene;
  EXPECT_TRUE(scene.has_tunnel);
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_EQ(scene.idle_lights.size(), 2U);
  EXPECT_FALSE(needs_paths(scene));
}

TEST(LightingUse, AnIdleTunnelIsKeptAndWrittenBack) {
  const Study study = lighting_study("lighting_use = \"ring+dome\"\n" + std::string(kLights));
  EXPECT_FALSE(study.scene.has_tunnel);
  EXPECT_EQ(study.scene.lights.size(), 2U);
  const Study again = lighting_study(resolved_text(study));
  EXPECT_FALSE(again.scene.has_tunnel);
  EXPECT_TRUE(again.scene.has_idle_tunnel);
  EXPECT_DOUBLE_EQ(again.scene.tunnel.radius_mm, 120.0);
  EXPECT_EQ(resolved_text(again), resolved_text(study));
}

TEST(LightingUse, IdleLightsAreCheckedAllTheSame) {
  EXPECT_THAT(lighting_error("lighting_use = \"tunnel\"\n" + std::string(kLights) +
                             "[lighting.bar]\nradiance = -1\n"),
              HasSubstr("lighting.bar.radiance"));
}

TEST(LightingUse, RefusesWhatIsNoSetOfLights) {
  const std::string lights = kLights;
  EXPECT_THAT(
      lighting_error("lighting_use = \"rign\"\n" + lights),
      HasSubstr("\"rign\" is no light; allowed are \"all\" and sets of tunnel, ring, dome"));
  EXPECT_THAT(lighting_error("lighting_use = \"ring+ring\"\n" + lights), HasSubstr("twice"));
  EXPECT_THAT(lighting_error("lighting_use = 3\n" + lights), HasSubstr("s.toml:1:"));
  EXPECT_THAT(
      lighting_error(lights + "[variables]\nlighting_use = { choices = [\"ring\", \"dom\"] }\n"
                              "[objective]\nmaximise = \"homogeneity.h_rms\"\n"
                              "[budget]\nevaluations = 9\n"),
      HasSubstr("\"dom\" is no light"));
}

TEST(LightingUse, IsAVariableWithConditionsOnSeveralValues) {
  const Study study = lighting_study(kLights + kSearch);
  const auto scene_at = [&](double kind) {
    return scene_with(study, overrides_of(study, canonical(study.space, Point{kind, 100, 60})));
  };
  EXPECT_FALSE(needs_paths(scene_at(0)));
  EXPECT_DOUBLE_EQ(scene_at(0).tunnel.radius_mm, 100.0);
  EXPECT_EQ(scene_at(1).lights.size(), 1U);
  EXPECT_EQ(scene_at(2).lights.size(), 2U);
  const auto active = [&](double kind, std::size_t index) {
    return is_active(study.space, Point{kind, 100, 60}, index);
  };
  EXPECT_TRUE(active(0, 1) && !active(0, 2));
  EXPECT_TRUE(!active(1, 1) && active(1, 2));
  EXPECT_TRUE(!active(2, 1) && active(2, 2));
}

// A condition on a variable that has a condition itself: the radius is asked for only while the
// tunnel shines and is round.
TEST(LightingUse, ConditionsMayStandOnConditions) {
  const Study study = lighting_study(kLights + std::string(R"([variables]
"lighting_use" = { choices = ["tunnel", "ring"] }
"lighting.tunnel.shape" = { choices = ["semicylinder", "ellipse"], when = "lighting_use == tunnel" }
"lighting.tunnel.radius_mm" = { min = 90, max = 150, when = "lighting.tunnel.shape == semicylinder" }
"lighting.tunnel.half_width_mm" = { min = 90, max = 150, when = "lighting.tunnel.shape in [ellipse]" }
"lighting.ring.leds" = { min = 8, max = 48, step = 8, when = "lighting_use == ring" }
"lighting.ring.led_diameter_mm" = { min = 2, max = 8, when = "lighting.ring.leds in [24, 32, 40]" }
[objective]
maximise = "homogeneity.h_rms"
[budget]
evaluations = 9
)"));
  const auto active = [&](double kind, double shape, double leds) {
    std::vector<bool> all;
    for (std::size_t i = 0; i < study.space.variables.size(); ++i) {
      all.push_back(is_active(study.space, Point{kind, shape, 100, 100, leds, 4}, i));
    }
    return all;
  };
  EXPECT_EQ(active(0, 0, 24), (std::vector<bool>{true, true, true, false, false, false}));
  EXPECT_EQ(active(0, 1, 24), (std::vector<bool>{true, true, false, true, false, false}));
  EXPECT_EQ(active(1, 0, 24), (std::vector<bool>{true, false, false, false, true, true}));
  EXPECT_EQ(active(1, 0, 8), (std::vector<bool>{true, false, false, false, true, false}));
  // What is not active keeps the file's value.
  const Point ring = canonical(study.space, Point{1, 1, 140, 140, 24, 3});
  const SceneSettings scene = scene_with(study, overrides_of(study, ring));
  EXPECT_DOUBLE_EQ(scene.tunnel.radius_mm, 120.0);
  EXPECT_EQ(std::get<RingSettings>(scene.lights[0].settings).leds, 24);
  EXPECT_DOUBLE_EQ(std::get<RingSettings>(scene.lights[0].settings).led_diameter_mm, 3.0);
}

TEST(LightingUse, AConditionOnNoVariableIsToldAtItsPlace) {
  const std::string text = kLights + std::string(R"([variables]
"lighting.ring.height_mm" = { min = 40, max = 90, when = "lighting_use == ring" }
[objective]
maximise = "homogeneity.h_rms"
[budget]
evaluations = 9
)");
  EXPECT_THAT(lighting_error(text),
              HasSubstr("s.toml:6:51: variables: lighting.ring.height_mm: when names the unknown "
                        "variable \"lighting_use\""));
}

TEST(LightingUse, RefusesConditionsThatCannotBeRead) {
  const auto with = [&](const std::string& when) {
    return lighting_error(kLights +
                          std::string("[variables]\n\"lighting_use\" = { choices = [\"tunnel\","
                                      "\"ring\"] }\n\"lighting.tunnel.radius_mm\" = { min = "
                                      "90, max = 150, when = \"") +
                          when +
                          "\" }\n[objective]\nmaximise = \"homogeneity.h_rms\"\n[budget]\n"
                          "evaluations = 9\n");
  };
  EXPECT_EQ(with("lighting_use in [tunnel]"), "");
  EXPECT_THAT(with("lighting_use in tunnel"), HasSubstr("path in [value, value]"));
  EXPECT_THAT(with("lighting_use in []"), HasSubstr("path in [value, value]"));
  EXPECT_THAT(with("lighting_use in [tunnel, dome]"), HasSubstr("\"dome\""));
}

// A run that was begun before the keys were there goes on: their defaults are not in the hash.
TEST(LightingUse, ItsDefaultIsNotInTheHash) {
  const std::string hash = config_hash(lighting_study(kLights));
  EXPECT_EQ(config_hash(lighting_study("lighting_use = \"all\"\n" + std::string(kLights))), hash);
  EXPECT_NE(config_hash(lighting_study("lighting_use = \"ring\"\n" + std::string(kLights))), hash);
}

std::string error_in_the_hand(const std::string& text) {
  const SceneSettings scene = lighting_study(text).scene;
  try {
    check_lights_go_along(scene);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

// A robot's flange holds the scene with its part: what stands in the scene cannot come along.
TEST(LightsInTheHand, StandOnCameraOrPart) {
  const std::string ring = "[lighting.ring]\nmount = ";
  EXPECT_EQ(error_in_the_hand(ring + "\"camera\"\n[lighting.environment]\n"), "");
  EXPECT_EQ(error_in_the_hand(ring + "\"part\"\n"), "");
  EXPECT_THAT(error_in_the_hand(ring + "\"scene\"\n"),
              HasSubstr("lighting.ring.mount: is \"scene\""));
  EXPECT_THAT(error_in_the_hand("[lighting.arch]\ntype = \"tunnel\"\n"),
              HasSubstr("lighting.arch: is a tunnel, which stands in the scene"));
  const std::string sky = "lighting_use = \"sky\"\n[lighting.sky]\ntype = \"environment\"\n";
  EXPECT_EQ(error_in_the_hand(sky + ring + "\"part\"\n"), "");
  EXPECT_THAT(error_in_the_hand(sky + ring + "\"scene\"\n"),
              HasSubstr("lighting.ring.mount: is \"scene\""))
      << "it does not shine, and stands there";
  EXPECT_THAT(error_in_the_hand(sky + "[lighting.arch]\ntype = \"tunnel\"\n"),
              HasSubstr("lighting.arch: is a tunnel"));
}

TEST(ExposeTo, IsReadAndRefusesMethodsWithDerivatives) {
  const std::string sensor = "[sensor]\nexpose_to = 0.9\n";
  EXPECT_DOUBLE_EQ(lighting_study(sensor).scene.expose_to, 0.9);
  EXPECT_THAT(lighting_error("[sensor]\nexpose_to = 1.5\n"), HasSubstr("sensor.expose_to"));
  EXPECT_THAT(
      lighting_error(sensor + "[variables]\n\"lighting.tunnel.radius_mm\" = { min = 90, max = "
                              "150 }\n[objective]\nmaximise = \"homogeneity.h_rms\"\n[search]\n"
                              "algorithm = \"slsqp\"\n[budget]\nevaluations = 9\n"),
      HasSubstr("sensor.expose_to sets the exposure"));
}

}  // namespace
}  // namespace glint
