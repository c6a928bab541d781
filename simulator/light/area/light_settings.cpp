// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/light_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr std::array<std::string_view, 3> kMountNames = {"scene", "part", "camera"};
constexpr std::array<std::string_view, 7> kTypeNames = {
    "ring", "dome", "bar", "coaxial", "mesh", "environment", "ies"};
static_assert(kTypeNames.size() == std::variant_size_v<LightSettings>);

constexpr Range kSize_mm = {.min = 1e-2, .max = 1e5};
constexpr Range kPlace_mm = {.min = -1e5, .max = 1e5};
constexpr Range kBrightness = {.min = 0.0, .max = 1e9};

void require_channels(KeyVisitor& keys, std::string_view key, const std::vector<double>& values) {
  keys.require(values.size() != 2,
               key,
               "has 2 values, must have 1 (grey) or 3 (one per channel of the sensor)");
}

template <std::size_t... index>
std::optional<LightSettings> default_of(std::size_t wanted, std::index_sequence<index...> /*all*/) {
  std::optional<LightSettings> found;
  ((index == wanted ? void(found.emplace(std::in_place_index<index>)) : void()), ...);
  return found;
}

}  // namespace

void visit_keys(KeyVisitor& keys, LightPlacement& s) {
  const Count three = {.min = 3, .max = 3};
  keys.choice(
      "mount",
      s.mount,
      kMountNames,
      "what the light is fixed to: the scene (it stays), the part (it moves with the part's "
      "position and rotation), or the camera");
  keys.numbers(
      "position_mm",
      s.position_mm,
      three,
      kPlace_mm,
      "of the light in the frame it is fixed in; the camera's: x right, y down, z forward");
  keys.numbers("direction",
               s.direction,
               {.min = 0, .max = 3},
               Range{},
               "the way the light's axis shines; empty: towards the part");
  keys.number("roll_deg", s.roll_rad, Range::between(-360, 360), "about the light's axis");
  double squares = 0.0;
  for (const double value : s.direction) {
    squares += value * value;
  }
  keys.require(
      s.direction.empty() || (s.direction.size() == 3 && squares > 0.0 && std::isfinite(squares)),
      "direction",
      "must be 3 numbers that are not all zero, or empty");
}

void visit_keys(KeyVisitor& keys, LightEmission& s) {
  keys.numbers("radiance",
               s.radiance,
               {.min = 1, .max = 3},
               kBrightness,
               "along the normal, 1 = full scale of the sensor when looking at it; 1 or 3 values");
  keys.numbers("power_w",
               s.power_w,
               {.min = 0, .max = 3},
               kBrightness,
               "whole flux instead of radiance; radiance 1 of a Lambertian surface is pi W / m^2");
  keys.number("half_angle_deg",
              s.half_angle_rad,
              Range{.min = 1, .max = 60},
              "angle at which the intensity has fallen to one half: LED lobe, 60 = Lambertian");
  require_channels(keys, "radiance", s.radiance);
  require_channels(keys, "power_w", s.power_w);
}

void visit_keys(KeyVisitor& keys, LightSegments& s) {
  keys.integer("segments", s.segments, Range::between(1, 1024), "equal parts that can be dimmed");
  keys.numbers("segment_power",
               s.segment_power,
               {.min = 0, .max = 1024},
               kBrightness,
               "factor of each segment; empty: 1 for all");
  keys.boolean("separate_segments",
               s.separate,
               "each segment is a light group, rendered by itself and varied for nothing");
  keys.require(
      s.segment_power.empty() || s.segment_power.size() == static_cast<std::size_t>(s.segments),
      "segment_power",
      fmt::format("has {} values, must have {} or none", s.segment_power.size(), s.segments));
}

void visit_keys(KeyVisitor& keys, RingSettings& s) {
  visit_keys(keys, s.placement);
  keys.number("inner_radius_mm", s.inner_radius_mm, Range::between(0, 1e5), "of the luminous ring");
  keys.number("outer_radius_mm", s.outer_radius_mm, kSize_mm, "of the luminous ring");
  keys.number("height_mm",
              s.height_mm,
              kPlace_mm,
              "of the ring above its position, against the way it shines; mount = \"camera\": in "
              "front of it");
  keys.number("tilt_deg",
              s.tilt_rad,
              Range::between(-90, 90),
              "turns the luminous surface about its middle radius, > 0 towards the axis");
  keys.integer("leds",
               s.leds,
               Range::between(0, 4096),
               "round LEDs on the middle radius; 0 = uniformly luminous ring");
  keys.number("led_diameter_mm", s.led_diameter_mm, kSize_mm, "luminous diameter of an LED");
  visit_keys(keys, s.segments);
  visit_keys(keys, s.emission);
  keys.require(s.outer_radius_mm > s.inner_radius_mm,
               "outer_radius_mm",
               fmt::format("is {:g}, must be greater than inner_radius_mm, {:g}",
                           s.outer_radius_mm,
                           s.inner_radius_mm));
  keys.require(
      s.leds == 0 || s.leds >= s.segments.segments,
      "leds",
      fmt::format("is {}, must be 0 or at least segments, {}", s.leds, s.segments.segments));
}

void visit_keys(KeyVisitor& keys, DomeSettings& s) {
  visit_keys(keys, s.placement);
  keys.number("radius_mm", s.radius_mm, kSize_mm, "of the sphere");
  keys.number("height_mm",
              s.height_mm,
              kPlace_mm,
              "of the sphere's centre above the position; mount = \"camera\": in front of it");
  keys.number("opening_mm",
              s.opening_mm,
              Range::between(0, 1e5),
              "diameter of the opening for the camera at the top");
  keys.number("rim_deg",
              s.rim_rad,
              Range{.min = 1, .max = 180},
              "angle from the top to the rim, seen from the centre; 90 = hemisphere");
  visit_keys(keys, s.emission);
  const double max_mm = 2.0 * s.radius_mm * std::sin(std::min(s.rim_rad, kPi / 2.0));
  keys.require(s.opening_mm < max_mm,
               "opening_mm",
               fmt::format("is {:g}, must be smaller than the dome, {:g}", s.opening_mm, max_mm));
}

void visit_keys(KeyVisitor& keys, BarSettings& s) {
  visit_keys(keys, s.placement);
  keys.number(
      "length_mm", s.length_mm, kSize_mm, "along the x axis of what it is fixed to, at roll 0");
  keys.number("width_mm", s.width_mm, kSize_mm, "of the luminous strip");
  visit_keys(keys, s.segments);
  visit_keys(keys, s.emission);
}

void visit_keys(KeyVisitor& keys, CoaxialSettings& s) {
  visit_keys(keys, s.placement);
  keys.number("width_mm", s.width_mm, kSize_mm, "of the luminous field");
  keys.number("height_mm", s.height_mm, kSize_mm, "of the luminous field");
  keys.number("reflectance",
              s.reflectance,
              Range::between(0, 1),
              "share of the light that the beam splitter sends to the part; what it takes from the "
              "way back to the camera belongs to the exposure");
  visit_keys(keys, s.emission);
}

void visit_keys(KeyVisitor& keys, MeshLightSettings& s) {
  visit_keys(keys, s.placement);
  keys.file("file", s.file, "triangle mesh in mm whose outer side shines; its +z is the axis");
  visit_keys(keys, s.emission);
}

void visit_keys(KeyVisitor& keys, EnvironmentSettings& s) {
  visit_keys(keys, s.placement);
  keys.file(
      "file", s.file, "latitude-longitude picture, top row along +z; empty: the same all round");
  keys.numbers("radiance",
               s.radiance,
               {.min = 1, .max = 3},
               kBrightness,
               "from everywhere, or factor of the picture's values; 1 or 3 values");
  require_channels(keys, "radiance", s.radiance);
}

void visit_keys(KeyVisitor& keys, IesLightSettings& s) {
  visit_keys(keys, s.placement);
  keys.file("file", s.file, "IES LM-63 file, type C");
  keys.numbers("scale",
               s.scale,
               {.min = 1, .max = 3},
               kBrightness,
               "W / sr for each unit of intensity in the file; 1 or 3 values");
  keys.number("length_mm",
              s.length_mm,
              Range::between(0, 1e5),
              "of the luminous opening, along horizontal angle 0; 0 = from the file");
  keys.number(
      "width_mm", s.width_mm, Range::between(0, 1e5), "of the luminous opening; 0 = from the file");
  require_channels(keys, "scale", s.scale);
}

void visit_keys(KeyVisitor& keys, LightSettings& settings) {
  std::visit([&keys](auto& held) { visit_keys(keys, held); }, settings);
}

std::span<const std::string_view> light_types() {
  return kTypeNames;
}

std::optional<LightSettings> default_light(std::string_view type) {
  const auto* const at = std::find(kTypeNames.begin(), kTypeNames.end(), type);
  const auto index = static_cast<std::size_t>(at - kTypeNames.begin());
  return default_of(index, std::make_index_sequence<kTypeNames.size()>());
}

std::string_view light_type(const LightSettings& settings) {
  return kTypeNames[settings.index()];
}

LightPlacement::Mount mount_of(const LightSettings& settings) {
  return std::visit([](const auto& held) { return held.placement.mount; }, settings);
}

bool is_surrounding(const LightSettings& settings) {
  return std::holds_alternative<EnvironmentSettings>(settings);
}

}  // namespace glint
