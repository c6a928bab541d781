// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "core/config/toml.h"
#include "core/file.h"
#include "core/text.h"
#include "studies/imaging/illuminated_place.h"

namespace glint {
namespace {

/// The slope of the smallest defect that must show, at its steepest.
constexpr double kSlope_rad = 0.02;

constexpr double kLargestPicture_px = 1000.0;

/// What the working distance and the part's size ask for, [mm] and pixels.
struct FirstSizes {
  double tilt_deg;  ///< of the part about the tunnel's axis
  double object_pixel_mm;
  int width_px;
  int height_px;
  double radius_mm;
  double slot_mm;
  double length_mm;
  double period_mm;
  double diameter_mm;  ///< of the defect
  double depth_mm;     ///< of the defect
};

/// @throws ConfigError when the camera would touch the part
FirstSizes first_sizes(const Eigen::Vector3d& upright_mm,
                       double tilt_deg,
                       double working_distance_mm) {
  const double cosine = std::cos(tilt_deg * kRadPerDeg);
  const double sine = std::sin(tilt_deg * kRadPerDeg);
  const Eigen::Vector3d size_mm(upright_mm.x(),
                                cosine * upright_mm.y() + sine * upright_mm.z(),
                                sine * upright_mm.y() + cosine * upright_mm.z());
  const double top_mm = 0.5 * size_mm.z();
  const double reach_mm = 0.5 * std::hypot(size_mm.y(), size_mm.z());
  const double largest_radius_mm = 0.8 * working_distance_mm;
  if (largest_radius_mm < 1.1 * reach_mm) {
    throw ConfigError(fmt::format(
        "--working_distance_mm: {:g} mm leaves no room for a tunnel between camera and part, which "
        "is {:.4g} x {:.4g} x {:.4g} mm large; must be at least {:.0f} mm",
        working_distance_mm,
        upright_mm.x(),
        upright_mm.y(),
        upright_mm.z(),
        std::ceil(1.1 * reach_mm / 0.8)));
  }
  FirstSizes first{.tilt_deg = tilt_deg};
  // The top of the part is nearer to the camera than its middle and looks larger.
  const double enlarged = working_distance_mm / (working_distance_mm - top_mm);
  const double extent_mm = std::max(size_mm.x(), size_mm.y());
  first.object_pixel_mm = extent_mm / kLargestPicture_px;
  const auto pixels = [&](double size) {
    return static_cast<int>(std::ceil(1.1 * enlarged * size / first.object_pixel_mm / 16.0)) * 16;
  };
  first.width_px = pixels(size_mm.x());
  first.height_px = pixels(size_mm.y());
  first.radius_mm = std::min(std::ceil(2.0 * reach_mm + 20.0), largest_radius_mm);
  // The view narrows from the part to the pinhole; the slot lets it through.
  const double narrowed = (working_distance_mm - first.radius_mm) / (working_distance_mm - top_mm);
  first.slot_mm = std::ceil(size_mm.y() * std::max(0.0, narrowed) + 2.0);
  first.length_mm = std::ceil(size_mm.x() + 6.0 * first.radius_mm);
  first.period_mm = std::max(1.0, std::round(first.radius_mm / 6.0));
  first.diameter_mm = 0.01 * extent_mm;
  // Depth / (sigma sqrt(e)) is a Gaussian dent's largest slope; its diameter is 4 sigma.
  first.depth_mm = kSlope_rad * 0.25 * first.diameter_mm * std::exp(0.5);
  return first;
}

/// The camera's data sheet as TOML keys: from a file, or from "key=value,key=value".
std::string camera_keys(const NewArguments& arguments, const FirstSizes& first) {
  if (arguments.camera.empty()) {
    return fmt::format("width_px = {}\nheight_px = {}\nobject_pixel_mm = {:.4g}\n",
                       first.width_px,
                       first.height_px,
                       first.object_pixel_mm);
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

constexpr const char* kTemplate = R"(# A lighting study for {name}, written by `glint new`.
# `glint explain KEY` says what a key means, its unit, range and default.
# `glint check {file}` validates this file, `glint run {file}` runs it.
schema = 1
title = {title}

[part]
file = {part}
unit = "{unit}"        # of the file
# crease_deg = 30     # edges sharper than this stay sharp; flatter ones are smoothed
rotation_deg = [{tilt}, 0, 0]   # flat faces that look straight at the camera would mirror its slot

[camera]
working_distance_mm = {distance}
{camera}
[sensor]
gain = 2.0            # saturation makes defects show in the mean of a scan
blur_px = 0.7
bits = 8
full_well_e = 10000   # noise of a common CMOS camera
read_noise_e = 6

[scan]
positions = 24        # pictures; a multiple of 1 / duty keeps the flawless surface even

[lighting.tunnel]
shape = "semicylinder"
radius_mm = {radius}
slot_mm = {slot}          # lets the camera look in
length_mm = {length}
period_mm = {period}
duty = 0.5

# The smallest defect that must show: a dent of at most 20 mrad, where the camera sees it and light
# reaches it, as near to the middle of the picture as the part allows.
[defects.dent]
x_mm = [{dent_x}]
y_mm = [{dent_y}]
height_um = {depth}
diameter_mm = {diameter}

# What the search may change.
[variables]
"lighting.tunnel.radius_mm" = {{ min = {radius_min}, max = {radius_max} }}
"lighting.tunnel.base_mm" = {{ min = {base_min}, max = {base_max} }}
"lighting.tunnel.slot_mm" = {{ min = {slot_min}, max = {slot_max} }}
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

/// The part's file as the study names it: relative to the study.
std::string part_path(const NewArguments& arguments) {
  const std::filesystem::path folder =
      std::filesystem::absolute(arguments.out.empty() ? "study.toml" : arguments.out)
          .lexically_normal()
          .parent_path();
  const std::filesystem::path part = std::filesystem::absolute(arguments.part).lexically_normal();
  return part.lexically_relative(folder).generic_string();
}

std::string in_quotes(const std::string& text) {
  return value_to_toml(ConfigNode::from_text(text));
}

std::string study_text(const NewArguments& arguments,
                       const std::string& name,
                       const FirstSizes& first,
                       const Eigen::Vector2d& place) {
  const auto rounded = [](double value) { return fmt::format("{:.4g}", value); };
  const auto place_mm = [](double value) { return fmt::format("{:.3f}", value); };
  const double largest_radius_mm = std::max(
      first.radius_mm, std::min(2.0 * first.radius_mm, 0.9 * arguments.working_distance_mm));
  return fmt::format(
      fmt::runtime(kTemplate),
      fmt::arg("name", name),
      fmt::arg("title", in_quotes("Fringe tunnel for " + name)),
      fmt::arg("file", arguments.out.empty() ? "study.toml" : arguments.out.string()),
      fmt::arg("part", in_quotes(part_path(arguments))),
      fmt::arg("unit", arguments.unit),
      fmt::arg("tilt", shortest(first.tilt_deg)),
      fmt::arg("distance", shortest(arguments.working_distance_mm)),
      fmt::arg("camera", camera_keys(arguments, first)),
      fmt::arg("radius", rounded(first.radius_mm)),
      fmt::arg("slot", rounded(first.slot_mm)),
      fmt::arg("length", rounded(first.length_mm)),
      fmt::arg("period", rounded(first.period_mm)),
      fmt::arg("dent_x", place_mm(place.x())),
      fmt::arg("dent_y", place_mm(place.y())),
      fmt::arg("depth", rounded(1000.0 * first.depth_mm)),
      fmt::arg("diameter", rounded(first.diameter_mm)),
      fmt::arg("radius_min", rounded(first.radius_mm)),
      fmt::arg("radius_max", rounded(largest_radius_mm)),
      fmt::arg("base_min", rounded(-0.2 * first.radius_mm)),
      fmt::arg("base_max", rounded(0.1 * first.radius_mm)),
      fmt::arg("slot_min", rounded(0.7 * first.slot_mm)),
      fmt::arg("slot_max", rounded(1.2 * first.slot_mm)),
      fmt::arg("period_min", rounded(0.25 * first.period_mm)),
      fmt::arg("period_max", rounded(2.0 * first.period_mm)));
}

PartSettings part_settings(const NewArguments& arguments) {
  ConfigNode table = ConfigNode::table();
  set_path(table, "file", ConfigNode::from_text(arguments.part.string()));
  set_path(table, "unit", ConfigNode::from_text(arguments.unit));
  std::vector<Problem> errors;
  PartSettings settings;
  KeyReader reader(&table, "part", errors);
  visit_keys(reader, settings);
  throw_if_any(errors);
  return settings;
}

/// A study with its defect where it can show.
struct Draft {
  std::string text;
  double lit_share = -1.0;
};

/// Empty when no place of the part is both seen and lit.
std::optional<Draft> draft(const NewArguments& arguments,
                           const PartSettings& part,
                           double tilt_deg,
                           SceneStore& store) {
  const auto built = store.build({.part = part});
  const FirstSizes first =
      first_sizes(built->part.box_in_part_mm.size_mm(), tilt_deg, arguments.working_distance_mm);
  const auto text_for = [&](const Eigen::Vector2d& place) {
    return study_text(arguments, built->part.name, first, place);
  };
  std::vector<Problem> errors;
  // In the folder of the file to come: paths in it are relative to that.
  const std::string name = (arguments.out.parent_path() / "new study").string();
  SceneSettings scene = read_scene(parse_toml(text_for(Eigen::Vector2d::Zero()), name), errors);
  throw_if_any(errors);
  scene.part.file = part.file;
  constexpr double kBackgroundDiameters = 2.5;
  const auto place = illuminated_place(store, scene, kBackgroundDiameters * first.diameter_mm);
  if (!place) {
    return std::nullopt;
  }
  return Draft{.text = text_for(place->place_mm), .lit_share = place->lit_share};
}

/// Tries the part upright and tilted, and takes what most of the light reaches.
std::string study_text(const NewArguments& arguments, int threads) {
  ThreadPool pool(threads);
  SceneStore store(pool);
  const PartSettings part = part_settings(arguments);
  Draft best;
  for (const double tilt_deg : {0.0, 15.0, 30.0}) {
    const auto one = draft(arguments, part, tilt_deg, store);
    if (one && one->lit_share > best.lit_share) {
      best = *one;
    }
  }
  if (best.text.empty()) {
    throw ConfigError(fmt::format(
        "{}: no place of the part is both seen by the camera and lit; another side may be, turn "
        "the part before it is saved",
        arguments.part.string()));
  }
  return best.text;
}

}  // namespace

int new_command(const NewArguments& arguments, const CommonArguments& common) {
  const std::filesystem::path folder = arguments.out.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder)) {
    throw IoError(arguments.out.string() + ": cannot be written: No such file or directory");
  }
  if (!arguments.out.empty() && std::filesystem::exists(arguments.out)) {
    throw ConfigError(arguments.out.string() + ": exists already; give --out another name");
  }
  const std::string text = study_text(arguments, common.threads);
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
