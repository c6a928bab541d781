// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/stability_sweeps.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"
#include "studies/definition/ladder/larger_pixels.h"
#include "studies/definition/overrides.h"
#include "studies/stability/light_sweeps.h"
#include "studies/stability/part_sweeps.h"

namespace glint::stability {
namespace {

/// Puts the tunnel's own name into the keys that are set.
void name_tunnel(const std::string& name, Sweep& sweep) {
  const std::string builtin = "lighting.tunnel.";
  const auto rename = [&](std::vector<KeyValue>& sets) {
    for (KeyValue& set : sets) {
      if (set.path.starts_with(builtin)) {
        set.path = "lighting." + name + "." + set.path.substr(builtin.size());
      }
    }
  };
  rename(sweep.sets);
  for (SweepValue& value : sweep.values) {
    rename(value.sets);
  }
}

ConfigNode in_larger_pixels(const ConfigNode& root, int factor) {
  std::vector<Problem> problems;
  const SceneSettings scene = read_scene(root, problems);
  if (!problems.empty()) {
    throw ConfigError(problems);
  }
  return write_scene(with_larger_pixels(scene, factor));
}

}  // namespace

std::string_view base_scene_text() {
  return R"(schema = 1
[part]
shape = "strip"
length_mm = 190
width_mm = 44
radius_along_mm = 400
radius_across_mm = 40
[camera]
width_px = 163
height_px = 38
object_pixel_mm = 1.2
working_distance_mm = 600
[sensor]
gain = 1.5
blur_px = 1
bits = 0
[scan]
positions = 24
[lighting.tunnel]
shape = "semicylinder"
radius_mm = 200
slot_mm = 32
length_mm = 1600
period_mm = 16
[defects.dent]
x_mm = [-50, 40]
y_mm = [-8, 9]
height_um = 40
diameter_mm = 8
)";
}

std::string_view bar_scene_text() {
  return R"(schema = 1
[part]
shape = "plate"
length_mm = 60
width_mm = 40
[material]
type = "diffuse"
roughness = 0
reflectance = [0.8]
[camera]
width_px = 68
height_px = 48
object_pixel_mm = 1
working_distance_mm = 400
[sensor]
blur_px = 0
bits = 0
[render.paths]
samples = 256
max_reflections = 1
[lighting.bar]
type = "bar"
position_mm = [0, 21, 171.5]
direction = [0, -1, 0]
length_mm = 40
width_mm = 40
)";
}

std::string number_text(double value) {
  return shortest(value);
}

std::vector<KeyValue> quiet_wall() {
  return {{"lighting.tunnel.slot_mm", "0"}, {"lighting.tunnel.blocks_view", "false"}};
}

std::vector<SweepValue> key_values(const std::string& key,
                                   const std::vector<double>& values,
                                   const std::string& method) {
  std::vector<SweepValue> cells;
  for (const double value : values) {
    cells.push_back({.value = value, .sets = {{key, number_text(value)}}, .method = method});
  }
  return cells;
}

void reduce_camera(CameraSettings& camera) {
  const double pixels = static_cast<double>(camera.width_px) * camera.height_px;
  const double factor = std::max(1.0, std::sqrt(pixels / kMaxPixels));
  camera.width_px = static_cast<int>(camera.width_px / factor);
  camera.height_px = static_cast<int>(camera.height_px / factor);
  camera.object_pixel_mm *= factor;
}

SweptScene swept_scene(SceneSettings scene) {
  reduce_camera(scene.camera);
  return {.is_builtin = false,
          .pixel_mm = scene.camera.object_pixel_mm,
          .period_mm = scene.tunnel.period_mm,
          .tunnel = scene.tunnel_name};
}

std::vector<Sweep> all_sweeps(const SweptScene& scene) {
  std::vector<Sweep> all = light_sweeps(scene);
  std::ranges::move(part_sweeps(), std::back_inserter(all));
  if (!scene.is_builtin) {
    std::erase_if(all, &Sweep::has_own_sizes);
    for (Sweep& sweep : all) {
      name_tunnel(scene.tunnel, sweep);
    }
  }
  return all;
}

std::vector<Sweep> chosen_sweeps(const std::vector<std::string>& names, const SweptScene& scene) {
  std::vector<Sweep> all = all_sweeps(scene);
  for (const std::string& name : names) {
    if (std::ranges::find(all, name, &Sweep::name) == all.end()) {
      std::string known;
      for (const Sweep& sweep : all) {
        known += (known.empty() ? "" : ", ") + sweep.name;
      }
      throw ConfigError(
          "--sweep",
          fmt::format(
              "is \"{}\", allowed{}: {}", name, scene.is_builtin ? "" : " beside a STUDY", known));
    }
  }
  if (!names.empty()) {
    std::erase_if(all, [&](const Sweep& sweep) {
      return std::ranges::find(names, sweep.name) == names.end();
    });
  }
  return all;
}

ConfigNode scene_tables_of(const ConfigNode& base, const Sweep& sweep, const SweepValue& value) {
  ConfigNode root = base;
  for (const KeyValue& set : sweep.sets) {
    put_set(root, set.path, set.value);
  }
  put_set(root, "render.method", value.method);
  for (const KeyValue& set : value.sets) {
    put_set(root, set.path, set.value);
  }
  return value.pixel_factor > 1 ? in_larger_pixels(root, value.pixel_factor) : root;
}

}  // namespace glint::stability
