// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/light_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "tests/simulator/light/area/light_scenes.h"

namespace glint {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// Problems of a table of that type.
std::vector<std::string> problems(std::string_view type, std::string_view toml) {
  const ConfigNode table = parse_toml(toml, "scene.toml");
  LightSettings settings = default_light(type).value();
  std::vector<Problem> errors;
  KeyReader reader(&table, "lighting.x", errors);
  visit_keys(reader, settings);
  reader.report_unknown();
  return messages_of(errors);
}

TEST(LightSettings, KnowsEveryTypeByItsName) {
  for (const std::string_view type : light_types()) {
    ASSERT_TRUE(default_light(type).has_value()) << type;
    EXPECT_EQ(light_type(*default_light(type)), type);
  }
  EXPECT_FALSE(default_light("lamp").has_value());
}

TEST(LightSettings, ReadBackWhatTheyWrite) {
  for (const std::string_view type : light_types()) {
    LightSettings settings = *default_light(type);
    ConfigNode written = ConfigNode::table();
    KeyWriter writer(written);
    visit_keys(writer, settings);
    EXPECT_TRUE(problems(type, to_toml(written)).empty()) << type;
  }
}

TEST(LightSettings, RefuseWhatCannotBe) {
  EXPECT_TRUE(problems("ring",
                       "inner_radius_mm = 20\ntilt_deg = 30\nsegments = 2\n"
                       "segment_power = [1, 0.5]")
                  .empty());
  EXPECT_THAT(problems("ring", "outer_radius_mm = 20"), Contains(HasSubstr("inner_radius_mm, 25")));
  EXPECT_THAT(problems("ring", "segments = 3\nsegment_power = [1]"),
              Contains(HasSubstr("must have 3 or none")));
  EXPECT_THAT(problems("ring", "segments = 3\nleds = 2"), Contains(HasSubstr("at least segments")));
  EXPECT_THAT(problems("bar", "radiance = [1, 2]"), Contains(HasSubstr("must have 1 (grey) or 3")));
  EXPECT_THAT(problems("bar", "direction = [0, 0]"), Contains(HasSubstr("not all zero")));
  EXPECT_THAT(problems("dome", "opening_mm = 300"), Contains(HasSubstr("smaller than the dome")));
  EXPECT_THAT(problems("dome", "half_angle_deg = 70"), Contains(HasSubstr("half_angle_deg")));
}

// The camera at (0, 0, 150) looks down with its x axis along the part's.
TEST(PlacedFrame, StandsOnThePartOrOnTheCamera) {
  const RigidTransform scene_from_camera = {.rotation = Eigen::DiagonalMatrix<double, 3>(1, -1, -1),
                                            .translation_mm = {0.0, 0.0, 150.0}};
  const EmitterFrame part = placed_frame({.position_mm = {1.0, 2.0, 3.0}}, scene_from_camera);
  EXPECT_EQ(part.origin_mm, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(part.z, Eigen::Vector3d(0.0, 0.0, -1.0));
  EXPECT_EQ(part.x, Eigen::Vector3d(1.0, 0.0, 0.0));
  const EmitterFrame camera =
      placed_frame({.mount = LightPlacement::Mount::kCamera, .position_mm = {0.0, 5.0, 16.0}},
                   scene_from_camera);
  EXPECT_EQ(camera.origin_mm, Eigen::Vector3d(0.0, -5.0, 134.0));
  EXPECT_EQ(camera.z, Eigen::Vector3d(0.0, 0.0, -1.0));
  const EmitterFrame turned =
      placed_frame({.direction = {2.0, 0.0, 0.0}, .roll_rad = kPi / 2.0}, {});
  EXPECT_LT((turned.x.cross(turned.y) - turned.z).norm(), 1e-12);
}

TEST(BuildLights, RefusesASecondEnvironmentAndALightWithoutArea) {
  const std::vector<NamedLight> two = {{.name = "a", .settings = EnvironmentSettings{}},
                                       {.name = "b", .settings = EnvironmentSettings{}}};
  EXPECT_THROW(build_lights(two, {}, {}), ConfigError);
  const std::vector<NamedLight> none = {
      {.name = "m", .settings = MeshLightSettings{.file = "empty"}}};
  const auto load = [](const std::filesystem::path&) { return std::vector<LightTriangle>{}; };
  EXPECT_THROW(build_lights(none, {}, load), ConfigError);
}

}  // namespace
}  // namespace glint
