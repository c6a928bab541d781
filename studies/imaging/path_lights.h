// SPDX-License-Identifier: GPL-3.0-or-later
//
// The lights of a scene at power 1, and what the powers of the scene make of them.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "simulator/light/area/build_lights.h"
#include "simulator/light/area/light_extent.h"
#include "simulator/material/local.h"
#include "studies/definition/scene.h"

namespace glint {

/// Lights whose radiance, scale and separate segments are 1; segments that are no groups of their
/// own keep their powers.
struct UnitPowerLights {
  Lights lights;  ///< factors of all groups are 1
  /// Flux of each group with all segments at 1; of the three channels alike, 0 for an environment.
  std::vector<Colour> unit_power_w;
};

/// The scene's lights without their powers.
std::vector<NamedLight> without_powers(std::vector<NamedLight> lights);

/// The tunnel as its picture depends on it: the light of dark stripes is a factor where one value
/// stands for all places.
TunnelSettings without_powers(TunnelSettings tunnel);

/// Turns off all lights but those of these names. Area lights stay in the scene with radiance 0, so
/// that what was rendered at power 1 serves for any of them; a tunnel is taken away.
void keep_lights(SceneSettings& scene, std::span<const std::string> names);

/// Names of the tables of lights that shine: the tunnel, and those with any radiance or power.
std::vector<std::string> shining_lights(const SceneSettings& scene);

/// Whether a light has any radiance or power.
bool shines(const LightSettings& settings);

/// Whether a light has a place: all but an environment.
bool has_place(const LightSettings& settings);

/// Whether a light is a body that stands in the way of others, also when it is off.
bool has_body(const LightSettings& settings);

/// The segments of a light that has some; else nullptr.
LightSegments* segments_of(LightSettings& settings);

/// How the stripes of a scan are moved.
struct StageScan {
  int positions = 1;     ///< 1 without a tunnel
  double step_mm = 0.0;  ///< from one to the next; 0 without a tunnel
};

/// @throws ConfigError as scan_step_mm()
StageScan stage_scan(const SceneSettings& scene);

/// How far a scan takes the stripes of the scene's tunnel until its offset_mm is made good, which
/// is along their normal [mm]; 0 without a tunnel.
/// @throws ConfigError where the stripes run along the scan, which takes them nowhere
double stripe_offset_mm(const SceneSettings& scene);

/// The room that the lights that shine take up: those on the camera where the first viewpoint has
/// them, a tunnel in the middle of its scan.
/// @throws ConfigError, IoError as extent_of()
LightExtent shining_extent(const SceneSettings& scene, const MeshLoader& load_mesh);

/// The triangles of a light that is a mesh, for build_lights(). @throws ConfigError, IoError
std::vector<LightTriangle> load_light_mesh(const std::filesystem::path& file);

/// @throws ConfigError, IoError as build_lights()
UnitPowerLights unit_power_lights(const SceneSettings& scene,
                                  const LightMounts& mounts,
                                  const MeshLoader& load_mesh);

/// What each light group contributes to one frame: a factor for each group, of its three channels
/// (equal for a grey sensor).
using FrameFactors = std::vector<Colour>;

/// The exposures of one evaluation: one under area lights alone, as many as scan.positions under a
/// tunnel. Each frame's factors for all groups: radiance or power of the lights, their separate
/// segments and the stripes of the tunnel.
/// @param unit_power_w  of each group of the scene's PathView, or of its picture
std::vector<FrameFactors> frame_factors(const SceneSettings& scene,
                                        std::span<const Colour> unit_power_w);

}  // namespace glint
