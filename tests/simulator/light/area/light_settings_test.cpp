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
// The part is lowered by 20 mm and turned by a quarter about z: its x axis is the scene's y.
TEST(PlacedFrame, StandsInTheSceneOnThePartOrOnTheCamera) {
  Eigen::Matrix3d quarter_turn;
  quarter_turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const LightMounts mounts = {
      .scene_from_camera = {.rotation = Eigen::DiagonalMatrix<double, 3>(1, -1, -1),
                            .translation_mm = {0.0, 0.0, 150.0}},
      .scene_from_part = {.rotation = quarter_turn, .translation_mm = {0.0, 0.0, -20.0}}};
  const EmitterFrame scene = placed_frame({.position_mm = {1.0, 2.0, 3.0}}, mounts);
  EXPECT_EQ(scene.origin_mm, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(scene.z, Eigen::Vector3d(0.0, 0.0, -1.0));
  EXPECT_EQ(scene.x, Eigen::Vector3d(1.0, 0.0, 0.0));
  const EmitterFrame part =
      placed_frame({.mount = LightPlacement::Mount::kPart, .position_mm = {1.0, 2.0, 3.0}}, mounts);
  EXPECT_EQ(part.origin_mm, Eigen::Vector3d(-2.0, 1.0, -17.0));
  EXPECT_EQ(part.z, Eigen::Vector3d(0.0, 0.0, -1.0));
  EXPECT_EQ(part.x, Eigen::Vector3d(0.0, 1.0, 0.0));
  const EmitterFrame camera = placed_frame(
      {.mount = LightPlacement::Mount::kCamera, .position_mm = {0.0, 5.0, 16.0}}, mounts);
  EXPECT_EQ(camera.origin_mm, Eigen::Vector3d(0.0, -5.0, 134.0));
  EXPECT_EQ(camera.z, Eigen::Vector3d(0.0, 0.0, -1.0));
  const EmitterFrame turned =
      placed_frame({.direction = {2.0, 0.0, 0.0}, .roll_rad = kPi / 2.0}, {});
  EXPECT_LT((turned.x.cross(turned.y) - turned.z).norm(), 1e-12);
}

/// The middle of each emitter of a ring, in the picture: x to the right, y downwards.
std::vector<Eigen::Vector2d> places_in_picture(const RingSettings& ring,
                                               const LightMounts& mounts) {
  const Lights lights = build_lights({{.name = "ring", .settings = ring}}, mounts, {});
  std::vector<Eigen::Vector2d> places;
  for (const Emitter& emitter : lights.emitters) {
    const auto& shape = std::get<RingShape>(emitter.shape);
    const double middle = shape.first_rad + 0.5 * shape.span_rad;
    const double radius = ring.leds > 0 ? 0.0 : shape.middle_radius_mm;
    const Eigen::Vector3d at = shape.frame.origin_mm + radius * (std::cos(middle) * shape.frame.x +
                                                                 std::sin(middle) * shape.frame.y);
    places.emplace_back((inverse(mounts.scene_from_camera) * at).head<2>());
  }
  return places;
}

// docs/images/ring_segments.svg: segment 0 from the right to the bottom, LED 0 half a pitch after
// the right, whatever the ring is fixed to. The camera looks down, the picture's top is +y.
TEST(RingLight, SegmentsAndLedsRunClockwiseFromTheRightOfThePicture) {
  const LightMounts mounts = {
      .scene_from_camera = {.rotation = Eigen::DiagonalMatrix<double, 3>(1, -1, -1),
                            .translation_mm = {0.0, 0.0, 150.0}}};
  using Mount = LightPlacement::Mount;
  for (const Mount mount : {Mount::kScene, Mount::kPart, Mount::kCamera}) {
    RingSettings ring = {.placement = {.mount = mount}, .segments = {.segments = 4}};
    const auto segments = places_in_picture(ring, mounts);
    ASSERT_EQ(segments.size(), 4U);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(std::atan2(segments[k].y(), segments[k].x()),
                  std::remainder((static_cast<double>(k) + 0.5) * kPi / 2.0, 2.0 * kPi),
                  1e-12);
    }
    ring.leds = 12;
    const auto leds = places_in_picture(ring, mounts);
    ASSERT_EQ(leds.size(), 12U);
    EXPECT_NEAR(std::atan2(leds[0].y(), leds[0].x()), 15.0 * kRadPerDeg, 1e-12);
    EXPECT_NEAR(std::atan2(leds[1].y(), leds[1].x()), 45.0 * kRadPerDeg, 1e-12);
  }
}

// The same figure: a bar's segment 0 is the one towards -x.
TEST(BarLight, SegmentsRunAlongX) {
  const BarSettings bar = {.segments = {.segments = 4}, .length_mm = 80.0};
  const Lights lights = build_lights({{.name = "bar", .settings = bar}}, {}, {});
  ASSERT_EQ(lights.emitters.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(std::get<RectangleShape>(lights.emitters[k].shape).frame.origin_mm.x(),
                -30.0 + 20.0 * static_cast<double>(k),
                1e-12);
  }
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
