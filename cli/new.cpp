// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "core/file.h"
#include "core/text.h"
#include "studies/scene.h"

namespace glint {
namespace {

/// The camera's data sheet as TOML keys: from a file, or from "key=value,key=value".
std::string camera_keys(const NewArguments& arguments, const Part& part) {
  if (arguments.camera.empty()) {
    // No data sheet: an image that the part fills by four fifths, of 0.15 mm pixels or finer.
    const Eigen::Vector3d size = part.box_in_part_mm.size_mm();
    const double pixel_mm = std::min(0.15, std::max(size.x(), size.y()) / 800.0);
    const auto pixels = [&](double extent) {
      return static_cast<int>(std::ceil(extent / 0.8 / pixel_mm / 16.0)) * 16;
    };
    return fmt::format("width_px = {}\nheight_px = {}\nobject_pixel_mm = {:.4g}\n",
                       pixels(size.x()),
                       pixels(size.y()),
                       pixel_mm);
  }
  std::error_code ignored;
  if (std::filesystem::exists(arguments.camera, ignored)) {
    const ConfigNode root = load_toml(arguments.camera);
    const ConfigNode* camera = root.find("camera");
    return to_toml(camera != nullptr ? *camera : root);
  }
  std::string keys;
  for (const std::string& pair : split(arguments.camera, ',')) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos) {
      throw ConfigError(fmt::format(
          "--camera {}: is no file, and \"{}\" is no key=value", arguments.camera, pair));
    }
    keys += fmt::format("{} = {}\n", pair.substr(0, equals), pair.substr(equals + 1));
  }
  return keys;
}

/// Sizes of a first tunnel around a part seen from a working distance.
struct FirstTunnel {
  double radius_mm;
  double slot_mm;
  double length_mm;
  double period_mm;
};

FirstTunnel first_tunnel(const Eigen::Vector3d& size_mm, double working_distance_mm) {
  const double half_width = 0.5 * std::hypot(size_mm.y(), size_mm.z());
  FirstTunnel tunnel{};
  tunnel.radius_mm = std::min(std::ceil(2.0 * half_width + 20.0), 0.8 * working_distance_mm);
  // The view cone narrows from the part to the pinhole; the slot must let it through.
  tunnel.slot_mm = std::ceil(size_mm.y() * (1.0 - tunnel.radius_mm / working_distance_mm) + 2.0);
  tunnel.length_mm = std::ceil(size_mm.x() + 6.0 * tunnel.radius_mm);
  tunnel.period_mm = std::max(2.0, std::round(tunnel.radius_mm / 6.0));
  return tunnel;
}

constexpr const char* kTemplate = R"(# A lighting study for {name}, written by `glint new`.
# `glint explain KEY` tells what a key means, its unit, range and default.
# `glint check {file}` validates this file, `glint run {file}` runs it.
schema = 1
title = "Fringe tunnel for {name}"

[part]
file = "{part}"
unit = "{unit}"        # of the file
# crease_deg = 30     # edges sharper than this stay sharp; flatter ones are smoothed

[camera]
working_distance_mm = {distance}
{camera}
[sensor]
gain = 2.0            # saturation makes defects show in the mean of a scan
blur_px = 0.7
bits = 8

[scan]
positions = 24        # pictures; a multiple of 1 / duty keeps the flawless surface even

[lighting.tunnel]
shape = "semicylinder"
radius_mm = {radius}
slot_mm = {slot}          # lets the camera look in
length_mm = {length}
period_mm = {period}
duty = 0.5

# The smallest defect that must show, near the middle of the part as the camera sees it.
[defects.dent]
x_mm = [{dent_x}]
y_mm = [{dent_y}]
height_um = 2.0
diameter_mm = {diameter}

# What the search may change.
[variables]
"lighting.tunnel.radius_mm" = {{ min = {radius_min}, max = {radius_max} }}
"lighting.tunnel.base_mm" = {{ min = {base_min}, max = {base_max} }}
"lighting.tunnel.period_mm" = {{ min = {period_min}, max = {period_max}, log = true }}
"sensor.gain" = {{ min = 1.2, max = 3.0 }}

[objective]
maximise = "homogeneity.h_rms"

# Without these an all-white picture would win.
[constraints]
"defects.min_cnr" = {{ min = 3 }}
"homogeneity.clipped_share" = {{ max = 0.01 }}

[search]
batch = 2

[budget]
evaluations = 200
)";

/// A place on the part that the camera sees, as near to the middle as possible.
Eigen::Vector2d visible_place(const Part& part) {
  const Bvh bvh(part.mesh);
  const Eigen::Vector3d size = part.box_in_part_mm.size_mm();
  constexpr int kRings = 40;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int k = 0; k < 8; ++k) {
      const double angle = k * kPi / 4.0;
      const Eigen::Vector2d at(0.45 * size.x() * ring / kRings * std::cos(angle),
                               0.45 * size.y() * ring / kRings * std::sin(angle));
      const auto place = place_on_surface(part, bvh, at.x(), at.y());
      if (place && place->normal.z() > 0.9) {
        return at;
      }
    }
  }
  throw ConfigError(
      "part.file: no place on the part faces the camera (+z); turn it with "
      "part.rotation_deg");
}

std::string study_text(const NewArguments& arguments, const Part& part) {
  const Eigen::Vector3d size = part.box_in_part_mm.size_mm();
  const FirstTunnel tunnel = first_tunnel(size, arguments.working_distance_mm);
  const Eigen::Vector2d place = visible_place(part);
  const std::filesystem::path folder = arguments.out.parent_path();
  const std::filesystem::path file =
      std::filesystem::absolute(arguments.part)
          .lexically_relative(std::filesystem::absolute(folder).lexically_normal());
  return fmt::format(
      fmt::runtime(kTemplate),
      fmt::arg("name", part.name),
      fmt::arg("file", arguments.out.empty() ? "study.toml" : arguments.out.string()),
      fmt::arg("part", file.string()),
      fmt::arg("unit", arguments.unit),
      fmt::arg("distance", shortest(arguments.working_distance_mm)),
      fmt::arg("camera", camera_keys(arguments, part)),
      fmt::arg("radius", shortest(tunnel.radius_mm)),
      fmt::arg("slot", shortest(tunnel.slot_mm)),
      fmt::arg("length", shortest(tunnel.length_mm)),
      fmt::arg("period", shortest(tunnel.period_mm)),
      fmt::arg("dent_x", fmt::format("{:.3f}", place.x())),
      fmt::arg("dent_y", fmt::format("{:.3f}", place.y())),
      fmt::arg("diameter", fmt::format("{:.2g}", std::max(0.3, size.x() / 100.0))),
      fmt::arg("radius_min", shortest(tunnel.radius_mm)),
      fmt::arg("radius_max", shortest(2.0 * tunnel.radius_mm)),
      fmt::arg("base_min", shortest(-0.2 * tunnel.radius_mm)),
      fmt::arg("base_max", shortest(0.2 * tunnel.radius_mm)),
      fmt::arg("period_min", shortest(0.5 * tunnel.period_mm)),
      fmt::arg("period_max", shortest(2.0 * tunnel.period_mm)));
}

PartSettings part_settings(const NewArguments& arguments) {
  ConfigNode table = ConfigNode::table();
  set_path(table, "file", ConfigNode::from_text(arguments.part.string()));
  set_path(table, "unit", ConfigNode::from_text(arguments.unit));
  std::vector<std::string> errors;
  PartSettings settings;
  KeyReader reader(&table, "part", errors);
  visit_keys(reader, settings);
  throw_if_any(errors);
  return settings;
}

}  // namespace

int new_command(const NewArguments& arguments, const CommonArguments& common) {
  const std::string text = study_text(arguments, build_part(part_settings(arguments)));
  parse_toml(text, "new study");  // what is handed out can be read
  if (arguments.out.empty()) {
    std::cout << text;
    return kExitDone;
  }
  write_file(arguments.out, text);
  load_study(arguments.out, {});
  print_result(common,
               {{"schema", 1}, {"status", "done"}, {"study", arguments.out.string()}},
               fmt::format("written: {0}\nnext: glint check {0}\n", arguments.out.string()));
  return kExitDone;
}

}  // namespace glint
