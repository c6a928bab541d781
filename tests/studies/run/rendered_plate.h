// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small path-traced scene, and its rendering into a folder.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/run/render_views.h"

namespace glint {

/// A plate with a dent, 100 mm below the camera, between a ring and a bar.
inline constexpr const char* kScene = R"(schema = 1
title = "Plate"
[part]
shape = "plate"
length_mm = 16
width_mm = 12
[material]
type = "conductor"
roughness = 0.3
[camera]
width_px = 60
height_px = 45
object_pixel_mm = 0.3
working_distance_mm = 100
[sensor]
exposure = 0.7
blur_px = 0
bits = 0
[render.paths]
samples = 8
max_reflections = 2
[lighting.ring]
type = "ring"
mount = "camera"
[lighting.bar]
type = "bar"
position_mm = [0, 60, 60]
direction = [0, -1, -1]
radiance = [0.5]
[defects.dent]
diameter_mm = 3
height_um = 100
)";

inline nlohmann::ordered_json render(const std::filesystem::path& folder,
                                     const std::string& text,
                                     RenderOptions options = {}) {
  write_file(folder / "scene.toml", text);
  options.out = folder / "out";
  options.progress = Progress::Style::kNone;
  return render_views(load_study(folder / "scene.toml", {}), options);
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  return text;
}

}  // namespace glint
