// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_lights.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <variant>

#include <fmt/format.h>

#include "core/error.h"
#include "core/pose.h"
#include "simulator/geometry/mesh_file/mesh_io.h"

namespace glint {
namespace {

/// The numbers of one light that act as factors.
struct LightPowers {
  std::vector<double> radiance = {1.0};
  std::vector<double> power_w;
  double passed = 1.0;  ///< share of the flux that reaches the scene
  std::vector<double> segment_power;
  int groups = 1;
};

template <class Light>
constexpr bool kHasSegments = requires(Light light) {
  light.segments;
};

template <class Light>
constexpr bool kHasEmission = requires(Light light) {
  light.emission;
};

LightPowers powers_of(const LightSettings& settings) {
  return std::visit(
      [](const auto& light) {
        using Light = std::decay_t<decltype(light)>;
        LightPowers powers;
        if constexpr (kHasEmission<Light>) {
          powers.radiance = light.emission.radiance;
          powers.power_w = light.emission.power_w;
        } else if constexpr (std::is_same_v<Light, IesLightSettings>) {
          powers.radiance = light.scale;
        } else {
          powers.radiance = light.radiance;
        }
        if constexpr (kHasSegments<Light>) {
          if (light.segments.separate) {
            powers.segment_power = light.segments.segment_power;
            powers.groups = light.segments.segments;
          }
        }
        if constexpr (std::is_same_v<Light, CoaxialSettings>) {
          powers.passed = light.reflectance;
        }
        return powers;
      },
      settings);
}

void clear_powers(LightSettings& settings, bool with_joined_segments) {
  std::visit(
      [&](auto& light) {
        using Light = std::decay_t<decltype(light)>;
        if constexpr (kHasEmission<Light>) {
          light.emission.radiance = {1.0};
          light.emission.power_w.clear();
        } else if constexpr (std::is_same_v<Light, IesLightSettings>) {
          light.scale = {1.0};
        } else {
          light.radiance = {1.0};
        }
        if constexpr (kHasSegments<Light>) {
          if (light.segments.separate || with_joined_segments) {
            light.segments.segment_power.clear();
          }
        }
      },
      settings);
}

void turn_off(LightSettings& settings) {
  std::visit(
      [](auto& light) {
        using Light = std::decay_t<decltype(light)>;
        if constexpr (kHasEmission<Light>) {
          light.emission.radiance = {0.0};
          light.emission.power_w.clear();
        } else if constexpr (std::is_same_v<Light, IesLightSettings>) {
          light.scale = {0.0};
        } else {
          light.radiance = {0.0};
        }
      },
      settings);
}

/// Whether segments in one group have powers, which change the flux at power 1.
bool has_joined_powers(const LightSettings& settings) {
  return std::visit(
      [](const auto& light) {
        if constexpr (kHasSegments<std::decay_t<decltype(light)>>) {
          return !light.segments.separate && !light.segments.segment_power.empty();
        }
        return false;
      },
      settings);
}

/// One value for all channels, or one for each.
Colour to_colour(const std::vector<double>& values) {
  return values.size() == 3 ? Colour(values[0], values[1], values[2])
                            : Colour::Constant(values.at(0));
}

std::optional<TunnelLight> tunnel_of(const SceneSettings& scene) {
  if (!scene.has_tunnel) {
    return std::nullopt;
  }
  return TunnelLight{.name = scene.tunnel_name,
                     .settings = scene.tunnel,
                     .positions = scene.scan.positions,
                     .step_mm = scan_step_mm(scene.scan, scene.tunnel)};
}

/// Factors of one light's groups.
void append_factors(const NamedLight& light,
                    std::span<const Colour> unit_power_w,
                    FrameFactors& factors) {
  const LightPowers powers = powers_of(light.settings);
  const std::size_t first = factors.size();
  const auto count = static_cast<std::size_t>(powers.groups);
  GLINT_CHECK(first + count <= unit_power_w.size(), "a power for each group");
  Colour factor = to_colour(powers.radiance);
  if (!powers.power_w.empty()) {
    Colour flux_w = Colour::Zero();
    for (std::size_t g = first; g < first + count; ++g) {
      flux_w += unit_power_w[g];
    }
    const Colour wanted_w = to_colour(powers.power_w) * powers.passed;
    if ((wanted_w > 0.0 && flux_w <= 0.0).any()) {
      throw ConfigError("lighting." + light.name + ".power_w",
                        "needs a light that sends light at power 1, and this one sends none; "
                        "allowed is radiance in its place");
    }
    factor = (flux_w > 0.0).select(wanted_w / flux_w, 0.0);
  }
  for (std::size_t k = 0; k < count; ++k) {
    factors.push_back(powers.segment_power.empty() ? factor : factor * powers.segment_power.at(k));
  }
}

/// A grey camera sees the mean of the channels.
void make_grey(FrameFactors& factors) {
  for (Colour& factor : factors) {
    factor = Colour::Constant(factor.mean());
  }
}

}  // namespace

bool shines(const LightSettings& settings) {
  const auto has_any = [](const std::vector<double>& values) {
    return std::ranges::any_of(values, [](double value) { return value > 0.0; });
  };
  return std::visit(
      [&](const auto& light) {
        using Light = std::decay_t<decltype(light)>;
        if constexpr (kHasEmission<Light>) {
          const LightEmission& emission = light.emission;
          return has_any(emission.power_w.empty() ? emission.radiance : emission.power_w);
        } else if constexpr (std::is_same_v<Light, IesLightSettings>) {
          return has_any(light.scale);
        } else {
          return has_any(light.radiance);
        }
      },
      settings);
}

bool has_place(const LightSettings& settings) {
  return !is_surrounding(settings);
}

bool has_body(const LightSettings& settings) {
  return std::visit([](const auto& light) { return kHasEmission<std::decay_t<decltype(light)>>; },
                    settings);
}

LightSegments* segments_of(LightSettings& settings) {
  return std::visit(
      [](auto& light) -> LightSegments* {
        if constexpr (kHasSegments<std::decay_t<decltype(light)>>) {
          return &light.segments;
        }
        return nullptr;
      },
      settings);
}

void keep_lights(SceneSettings& scene, std::span<const std::string> names) {
  const auto is_off = [&](const std::string& name) {
    return std::ranges::find(names, name) == names.end();
  };
  scene.has_tunnel = scene.has_tunnel && !is_off(scene.tunnel_name);
  for (NamedLight& light : scene.lights) {
    if (is_off(light.name)) {
      turn_off(light.settings);
    }
  }
}

std::vector<std::string> shining_lights(const SceneSettings& scene) {
  std::vector<std::string> names;
  if (scene.has_tunnel) {
    names.push_back(scene.tunnel_name);
  }
  for (const NamedLight& light : scene.lights) {
    if (shines(light.settings)) {
      names.push_back(light.name);
    }
  }
  return names;
}

LightExtent shining_extent(const SceneSettings& scene, const MeshLoader& load_mesh) {
  const LightMounts mounts = {
      .scene_from_camera = inverse(camera_from_world(scene.viewpoint())),
      .scene_from_part =
          pose_from_angles(vector_of(scene.part.position_mm), vector_of(scene.part.rotation_rad))};
  LightExtent extent;
  for (const NamedLight& light : scene.lights) {
    if (shines(light.settings)) {
      extent = together(extent, extent_of({light}, mounts, load_mesh));
    }
  }
  if (scene.has_tunnel) {
    const StageScan stage = stage_scan(scene);
    extent = together(extent, extent_of(scene.tunnel, 0.5 * (stage.positions - 1) * stage.step_mm));
  }
  return extent;
}

StageScan stage_scan(const SceneSettings& scene) {
  return scene.has_tunnel ? StageScan{.positions = scene.scan.positions,
                                      .step_mm = scan_step_mm(scene.scan, scene.tunnel)}
                          : StageScan{};
}

double stripe_offset_mm(const SceneSettings& scene) {
  constexpr double kMinStripeCosine = 0.01;  // as in scan_step_mm()
  if (!scene.has_tunnel || scene.tunnel.offset_mm == 0.0) {
    return 0.0;
  }
  const double cosine = std::cos(scene.tunnel.orientation_rad);
  if (cosine < kMinStripeCosine) {
    throw ConfigError(fmt::format("lighting.{}.offset_mm", scene.tunnel_name),
                      fmt::format("is {}, must be 0 where the stripes run along the scan",
                                  scene.tunnel.offset_mm));
  }
  return scene.tunnel.offset_mm / cosine;
}

std::vector<NamedLight> without_powers(std::vector<NamedLight> lights) {
  for (NamedLight& light : lights) {
    clear_powers(light.settings, false);
  }
  return lights;
}

TunnelSettings without_powers(TunnelSettings tunnel) {
  if (Tunnel(tunnel).dark().is_even()) {
    tunnel.dark_reflectance = 0.0;
  }
  return tunnel;
}

std::vector<LightTriangle> load_light_mesh(const std::filesystem::path& file) {
  const TriangleMesh mesh = read_mesh(file);
  std::vector<LightTriangle> triangles;
  for (std::size_t t = 0; t < mesh.num_triangles(); ++t) {
    triangles.push_back({mesh.vertex(t, 0), mesh.vertex(t, 1), mesh.vertex(t, 2)});
  }
  return triangles;
}

UnitPowerLights unit_power_lights(const SceneSettings& scene,
                                  const LightMounts& mounts,
                                  const MeshLoader& load_mesh) {
  const std::vector<NamedLight> unit = without_powers(scene.lights);
  const std::optional<TunnelLight> tunnel = tunnel_of(scene);
  UnitPowerLights result = {.lights = build_lights(unit, mounts, load_mesh, tunnel)};
  std::vector<LightGroup>& groups = result.lights.groups;
  for (LightGroup& group : groups) {
    group.factor = 1.0;
    result.unit_power_w.emplace_back(group.power_w.cast<double>());
  }
  std::size_t group = 0;
  for (NamedLight light : unit) {
    if (has_joined_powers(light.settings)) {
      clear_powers(light.settings, true);
      const Lights alone = build_lights({light}, mounts, load_mesh);
      result.unit_power_w[group] = alone.groups.front().power_w.cast<double>();
    }
    group += static_cast<std::size_t>(powers_of(light.settings).groups);
  }
  return result;
}

std::vector<FrameFactors> frame_factors(const SceneSettings& scene,
                                        std::span<const Colour> unit_power_w) {
  FrameFactors of_lights;
  for (const NamedLight& light : scene.lights) {
    append_factors(light, unit_power_w, of_lights);
  }
  if (scene.sensor.wavelengths_nm.size() == 1) {
    make_grey(of_lights);
  }
  const std::optional<TunnelLight> tunnel = tunnel_of(scene);
  if (!tunnel) {
    return {of_lights};
  }
  std::vector<FrameFactors> frames;
  for (const std::vector<double>& of_tunnel : tunnel_frame_factors(*tunnel)) {
    FrameFactors& factors = frames.emplace_back(of_lights);
    for (const double factor : of_tunnel) {
      factors.push_back(Colour::Constant(factor));
    }
  }
  return frames;
}

}  // namespace glint
