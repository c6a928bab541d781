// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/shell/output_file.h"
#include "core/config/toml.h"
#include "core/units.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "simulator/geometry/part/mesh_report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// The part of a TOML file, or a mesh with the unit and crease angle of the command line.
PartSettings settings_of(const PartArguments& arguments) {
  std::vector<Problem> errors;
  ConfigNode table = ConfigNode::table();
  ConfigNode root;
  if (arguments.file.extension() == ".toml") {
    root = load_toml(arguments.file);
    if (const ConfigNode* part = root.find("part")) {
      table = *part;
    }
  } else {
    if (std::error_code ignored; !std::filesystem::exists(arguments.file, ignored)) {
      throw IoError(arguments.file.string() + ": cannot be read: No such file or directory");
    }
    ConfigNode file = ConfigNode::from_text(arguments.file.string());
    set_path(table, "file", std::move(file));
    set_path(table, "unit", ConfigNode::from_text(arguments.unit));
    set_path(table, "crease_deg", ConfigNode::from_number(arguments.crease_deg));
  }
  PartSettings settings;
  KeyReader reader(&table, "part", errors);
  visit_keys(reader, settings);
  reader.report_unknown();
  throw_if_any(errors);
  return settings;
}

Json report_json(const MeshReport& r, const PartSettings& settings) {
  const Eigen::Vector3d& p = r.scene_from_part.translation_mm;
  return {{"schema", 1},
          {"status", "done"},
          {"name", r.name},
          {"unit", r.unit},
          {"size_mm", {r.size_mm.x(), r.size_mm.y(), r.size_mm.z()}},
          {"area_mm2", r.area_mm2},
          {"volume_mm3", r.volume_mm3},
          {"triangles", r.num_triangles},
          {"vertices", r.num_vertices},
          {"watertight", r.is_watertight},
          {"inside_out", r.is_inside_out},
          {"open_edges", r.open_edges},
          {"nonmanifold_edges", r.nonmanifold_edges},
          {"flipped_edges", r.flipped_edges},
          {"degenerate_triangles", r.degenerate_triangles},
          {"facet_angle_mrad", r.facet_angle_95_rad * 1e3},
          {"largest_facet_angle_mrad", r.largest_facet_angle_rad * 1e3},
          {"smallest_slope_mrad", r.smallest_slope_rad * 1e3},
          {"fine_enough", r.is_fine_enough},
          {"exact_surface", r.has_exact_surface},
          {"crease_deg", settings.crease_rad * kDegPerRad},
          {"pose",
           {{"position_mm", {p.x(), p.y(), p.z()}},
            {"rotation_deg",
             {settings.rotation_rad[0] * kDegPerRad,
              settings.rotation_rad[1] * kDegPerRad,
              settings.rotation_rad[2] * kDegPerRad}}}},
          {"verdict", r.verdict},
          {"action", r.action},
          {"warnings", r.warnings}};
}

std::string report_text(const MeshReport& r) {
  std::string text =
      fmt::format("{} ({}): {:.4g} x {:.4g} x {:.4g} mm, {} triangles, {} vertices\n",
                  r.name,
                  r.unit,
                  r.size_mm.x(),
                  r.size_mm.y(),
                  r.size_mm.z(),
                  r.num_triangles,
                  r.num_vertices);
  text += fmt::format("  area {:.6g} mm2", r.area_mm2);
  text += r.is_watertight ? fmt::format(", watertight, volume {:.6g} mm3\n", r.volume_mm3)
                          : fmt::format(", not watertight: {} open edges\n", r.open_edges);
  if (!r.has_exact_surface) {
    text += fmt::format("  facet angle {:.3g} mrad (95 %), {:.3g} mrad (largest)\n",
                        r.facet_angle_95_rad * 1e3,
                        r.largest_facet_angle_rad * 1e3);
  }
  text += "  " + r.verdict + "\n";
  if (!r.action.empty()) {
    text += "  " + r.action + "\n";
  }
  for (const std::string& warning : r.warnings) {
    text += "  warning: " + warning + "\n";
  }
  return text;
}

int tell_part(const PartArguments& arguments, const CommonArguments& common) {
  if (!arguments.out.empty() && std::filesystem::exists(arguments.out)) {
    throw ConfigError(arguments.out.string() + ": exists already; give --out another name");
  }
  const PartSettings settings = settings_of(arguments);
  const Part part = build_part(settings);
  const MeshReport mesh_report = report(part, arguments.slope_mrad * 1e-3, settings.crease_rad);
  Json json = report_json(mesh_report, settings);
  std::string text = report_text(mesh_report);
  if (!arguments.out.empty()) {
    const FolderOf folder(arguments.out);
    write_mesh(arguments.out, part.mesh);
    json["file"] = arguments.out.string();
    text += "written: " + arguments.out.string() + "\n";
  }
  print_result(common, json, text);
  return kExitDone;
}

}  // namespace

int part_command(const PartArguments& arguments, const CommonArguments& common) {
  try {
    return tell_part(arguments, common);
  } catch (const ConfigError& error) {
    throw arguments.file.extension() == ".toml" ? error : with_option_names(error);
  }
}

}  // namespace glint
