// SPDX-License-Identifier: GPL-3.0-or-later
//
// Keys of the area lights below [lighting.<name>]; docs/theory/lights.md has a drawing of each.
// Radiance is in W / (m^2 sr), relative: 1 is full scale of the sensor at exposure and gain 1.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/config/keys.h"
#include "core/units.h"

namespace glint {

/// Where a light is fixed and how it stands there.
struct LightPlacement {
  enum class Mount {
    kScene,  ///< stays where it is, wherever part and camera stand
    kPart,   ///< moves with part.position_mm and part.rotation_deg
    kCamera  ///< moves with the viewpoint
  };

  Mount mount = Mount::kScene;
  /// In the frame of the scene, of the part, or of the camera (x right, y down, z forward, origin
  /// in the pinhole).
  std::vector<double> position_mm = {0.0, 0.0, 0.0};
  /// The way its axis shines, any length; empty: towards the part (-z of scene and part,
  /// +z of the camera).
  std::vector<double> direction;
  double roll_rad = 0.0;  ///< about the axis
};

/// How bright a luminous surface is.
struct LightEmission {
  std::vector<double> radiance = {1.0};  ///< along the normal; one number or one per channel
  std::vector<double> power_w;           ///< whole flux; when given, it replaces the radiance
  double half_angle_rad = kPi / 3.0;     ///< where the intensity is one half; 60 deg = Lambertian
};

/// Parts of a light that have a power of their own.
struct LightSegments {
  int segments = 1;
  std::vector<double> segment_power;  ///< factor of each, empty: all 1
  bool separate = false;              ///< each segment is a light group of its own
};

struct RingSettings {
  LightPlacement placement;
  LightEmission emission;
  LightSegments segments;
  double inner_radius_mm = 25.0;
  double outer_radius_mm = 40.0;
  double height_mm = 0.0;
  double tilt_rad = 0.0;
  int leds = 0;
  double led_diameter_mm = 5.0;
};

struct DomeSettings {
  LightPlacement placement;
  LightEmission emission;
  double radius_mm = 100.0;
  double height_mm = 0.0;
  double opening_mm = 30.0;
  double rim_rad = kPi / 2.0;
};

struct BarSettings {
  LightPlacement placement = {.position_mm = {0.0, 0.0, 150.0}};
  LightEmission emission;
  LightSegments segments;
  double length_mm = 200.0;
  double width_mm = 20.0;
};

struct CoaxialSettings {
  LightPlacement placement = {.mount = LightPlacement::Mount::kCamera};
  LightEmission emission;
  double width_mm = 50.0;
  double height_mm = 50.0;
  double reflectance = 0.5;
};

struct MeshLightSettings {
  LightPlacement placement = {.direction = {0.0, 0.0, 1.0}};
  LightEmission emission;
  std::filesystem::path file;
};

struct EnvironmentSettings {
  LightPlacement placement = {.direction = {0.0, 0.0, 1.0}};
  std::vector<double> radiance = {1.0};
  std::filesystem::path file;
};

struct IesLightSettings {
  LightPlacement placement = {.position_mm = {0.0, 0.0, 500.0}};
  std::filesystem::path file;
  std::vector<double> scale = {1.0};
  double length_mm = 0.0;
  double width_mm = 0.0;
};

using LightSettings = std::variant<RingSettings,
                                   DomeSettings,
                                   BarSettings,
                                   CoaxialSettings,
                                   MeshLightSettings,
                                   EnvironmentSettings,
                                   IesLightSettings>;

void visit_keys(KeyVisitor& keys, LightPlacement& settings);
void visit_keys(KeyVisitor& keys, LightEmission& settings);
void visit_keys(KeyVisitor& keys, LightSegments& settings);
void visit_keys(KeyVisitor& keys, RingSettings& settings);
void visit_keys(KeyVisitor& keys, DomeSettings& settings);
void visit_keys(KeyVisitor& keys, BarSettings& settings);
void visit_keys(KeyVisitor& keys, CoaxialSettings& settings);
void visit_keys(KeyVisitor& keys, MeshLightSettings& settings);
void visit_keys(KeyVisitor& keys, EnvironmentSettings& settings);
void visit_keys(KeyVisitor& keys, IesLightSettings& settings);
/// Of the kind that it holds.
void visit_keys(KeyVisitor& keys, LightSettings& settings);

/// What stands in `type`: "ring", "dome", "bar", "coaxial", "mesh", "environment", "ies".
std::span<const std::string_view> light_types();

/// The defaults of a type; empty when there is none of that name.
std::optional<LightSettings> default_light(std::string_view type);

std::string_view light_type(const LightSettings& settings);

/// What the light is fixed to.
LightPlacement::Mount mount_of(const LightSettings& settings);

/// Whether the light comes from everywhere around the scene: no thing that stands somewhere.
bool is_surrounding(const LightSettings& settings);

}  // namespace glint
