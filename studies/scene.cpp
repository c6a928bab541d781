// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/scene.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/text.h"

namespace glint {
namespace {

template <class Settings>
void read_table(const ConfigNode& root,
                const std::string& path,
                Settings& settings,
                std::vector<std::string>& errors) {
  KeyReader reader(root.find(path), path, errors);
  visit_keys(reader, settings);
  reader.report_unknown();
}

template <class Settings>
void write_table(ConfigNode& root, const std::string& name, Settings settings) {
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, settings);
  root.names.push_back(name);
  root.items.push_back(std::move(table));
}

template <class Settings>
void list_table(const std::string& path, Settings settings, std::vector<KeyRow>& rows) {
  KeyLister lister(path, rows);
  visit_keys(lister, settings);
}

void read_viewpoint(const ConfigNode& root,
                    SceneSettings& scene,
                    std::vector<std::string>& errors) {
  scene.viewpoint = default_viewpoint(scene.camera);
  const ConfigNode* list = root.find("viewpoint");
  if (list == nullptr) {
    return;
  }
  if (!list->is_array() || list->items.size() != 1) {
    errors.push_back(list->place.prefix() +
                     "viewpoint: a scan has exactly one [[viewpoint]]; position_mm, direction, up");
    return;
  }
  KeyReader reader(&list->items.front(), "viewpoint.0", errors);
  visit_keys(reader, scene.viewpoint);
  reader.report_unknown();
}

void read_lighting(const ConfigNode& root, SceneSettings& scene, std::vector<std::string>& errors) {
  const ConfigNode* lighting = root.find("lighting");
  if (lighting == nullptr) {
    return;
  }
  const bool is_one_table =
      lighting->is_table() && lighting->items.size() == 1 && lighting->items.front().is_table();
  if (!is_one_table) {
    errors.push_back(lighting->place.prefix() +
                     "lighting: must hold exactly one light, like [lighting.tunnel]");
    return;
  }
  scene.tunnel_name = lighting->names.front();
  KeyReader reader(&lighting->items.front(), "lighting." + scene.tunnel_name, errors);
  std::string type = "tunnel";
  reader.text("type", type, "");
  reader.require(type == "tunnel", "type", fmt::format("is \"{}\", must be \"tunnel\"", type));
  visit_keys(reader, scene.tunnel);
  reader.report_unknown();
}

void read_defects(const ConfigNode& root, SceneSettings& scene, std::vector<std::string>& errors) {
  const ConfigNode* defects = root.find("defects");
  if (defects == nullptr) {
    return;
  }
  if (!defects->is_table()) {
    errors.push_back(defects->place.prefix() + "defects: must hold tables, like [defects.dent]");
    return;
  }
  for (std::size_t i = 0; i < defects->names.size(); ++i) {
    const std::string& name = defects->names[i];
    DefectGroup group;
    group.type = type_from_name(name);
    KeyReader reader(&defects->items[i], "defects." + name, errors);
    visit_keys(reader, group);
    reader.report_unknown();
    scene.defects.emplace_back(name, group);
  }
}

/// Length of the place a message begins with: "study.toml:4:1: " or "--set: "; 0 without one.
std::size_t place_size(const std::string& message) {
  const std::string set = "--set: ";
  if (message.starts_with(set)) {
    return set.size();
  }
  // The first ": " ends the place when a line and a column stand before it.
  const auto end = message.find(": ");
  const std::vector<std::string> parts = split(message.substr(0, end), ':');
  const auto is_number = [](const std::string& text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  };
  const bool is_place = end != std::string::npos && parts.size() >= 3 && is_number(parts.back()) &&
                        is_number(parts[parts.size() - 2]);
  return is_place ? end + 2 : 0;
}

}  // namespace

const std::vector<std::string>& scene_tables() {
  static const std::vector<std::string> names = {"part",
                                                 "camera",
                                                 "viewpoint",
                                                 "sensor",
                                                 "scan",
                                                 "render",
                                                 "lighting",
                                                 "defects",
                                                 "imprint",
                                                 "metrics",
                                                 "inspection"};
  return names;
}

SceneSettings read_scene(const ConfigNode& root, std::vector<std::string>& errors) {
  SceneSettings scene;
  read_table(root, "part", scene.part, errors);
  read_table(root, "camera", scene.camera, errors);
  read_viewpoint(root, scene, errors);
  read_table(root, "sensor", scene.sensor, errors);
  read_table(root, "scan", scene.scan, errors);
  read_table(root, "render", scene.render, errors);
  read_lighting(root, scene, errors);
  read_defects(root, scene, errors);
  read_table(root, "imprint", scene.imprint, errors);
  read_table(root, "metrics", scene.metrics, errors);
  read_table(root, "inspection", scene.inspection, errors);
  return scene;
}

ConfigNode write_scene(const SceneSettings& scene) {
  ConfigNode root = ConfigNode::table();
  write_table(root, "part", scene.part);
  write_table(root, "camera", scene.camera);
  ConfigNode viewpoints = ConfigNode::array();
  ConfigNode holder = ConfigNode::table();
  write_table(holder, "0", scene.viewpoint);
  viewpoints.items.push_back(std::move(holder.items.front()));
  root.names.emplace_back("viewpoint");
  root.items.push_back(std::move(viewpoints));
  write_table(root, "sensor", scene.sensor);
  write_table(root, "scan", scene.scan);
  write_table(root, "render", scene.render);
  ConfigNode lighting = ConfigNode::table();
  write_table(lighting, scene.tunnel_name, scene.tunnel);
  lighting.items.front().names.emplace_back("type");
  lighting.items.front().items.push_back(ConfigNode::from_text("tunnel"));
  root.names.emplace_back("lighting");
  root.items.push_back(std::move(lighting));
  ConfigNode defects = ConfigNode::table();
  for (const auto& [name, group] : scene.defects) {
    write_table(defects, name, group);
  }
  root.names.emplace_back("defects");
  root.items.push_back(std::move(defects));
  write_table(root, "imprint", scene.imprint);
  write_table(root, "metrics", scene.metrics);
  write_table(root, "inspection", scene.inspection);
  return root;
}

std::vector<KeyRow> scene_keys() {
  std::vector<KeyRow> rows;
  list_table("part", PartSettings{}, rows);
  list_table("camera", CameraSettings{}, rows);
  list_table("viewpoint.0", Viewpoint{}, rows);
  list_table("sensor", SensorSettings{}, rows);
  list_table("scan", ScanSettings{}, rows);
  list_table("render", RenderSettings{}, rows);
  list_table("lighting.tunnel", TunnelSettings{}, rows);
  list_table("defects.dent", DefectGroup{}, rows);
  list_table("imprint", ImprintSettings{}, rows);
  list_table("metrics", MetricsSettings{}, rows);
  list_table("inspection", InspectionSettings{}, rows);
  return rows;
}

std::string with_place(const ConfigNode& root, const std::string& message) {
  std::string key = message.substr(0, message.find(':'));
  const std::string table = key.substr(0, key.find('.'));
  if (std::ranges::find(scene_tables(), table) == scene_tables().end()) {
    return message;
  }
  // The key may have kept its default; then the table around it, or the file, is the place.
  while (!key.empty()) {
    const ConfigNode* node = root.at_path(key);
    if (node != nullptr && !node->place.file.empty()) {
      return node->place.prefix() + message;
    }
    const auto dot = key.rfind('.');
    key = dot == std::string::npos ? "" : key.substr(0, dot);
  }
  return root.place.file.empty() ? message : root.place.file + ": " + message;
}

std::string in_context(const std::string& message, const std::string& context) {
  std::vector<std::string> lines = split(message, '\n');
  for (std::string& line : lines) {
    line.insert(place_size(line), context + ": ");
  }
  return join(lines, "\n");
}

}  // namespace glint
