// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene_lights.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace glint {
namespace {

/// Whose light a table below [lighting] is.
struct LightType {
  std::string name;
  bool is_guessed = false;  ///< neither `type` nor the table's name says so
};

/// Its `type`, else its name, else a tunnel.
LightType light_type_of(const ConfigNode& table, const std::string& name) {
  const ConfigNode* type = table.find("type");
  if (type != nullptr && type->kind == ConfigNode::Kind::kText) {
    return {.name = type->text};
  }
  if (default_light(name)) {
    return {.name = name};
  }
  return {.name = "tunnel", .is_guessed = name != "tunnel" && type == nullptr};
}

/// What is wrong with a light whose type nobody gave may be that it is no tunnel.
void explain_guess(std::span<Problem> problems) {
  for (Problem& problem : problems) {
    problem.text +=
        fmt::format("; no type, so it is read as a tunnel; types are \"tunnel\", \"{}\"",
                    fmt::join(light_types(), "\", \""));
  }
}

void read_tunnel(KeyReader& reader,
                 const std::string& name,
                 const ConfigNode& table,
                 bool is_guessed,
                 SceneSettings& scene,
                 std::vector<Problem>& errors) {
  if (scene.has_tunnel) {
    errors.push_back(
        {.kind = Problem::Kind::kRelation,
         .place = table.place,
         .key = "lighting." + name,
         .text = scene.is_tunnel_guessed
                     ? fmt::format("is a second tunnel; at most one is allowed, and "
                                   "lighting.{} has no type, so it is read as a tunnel",
                                   scene.tunnel_name)
                     : "is a second tunnel; at most one is allowed"});
  }
  scene.has_tunnel = true;
  scene.tunnel_name = name;
  scene.is_tunnel_guessed = is_guessed;
  visit_keys(reader, scene.tunnel);
}

void read_light(const ConfigNode& table,
                const std::string& name,
                SceneSettings& scene,
                std::vector<Problem>& errors) {
  const std::size_t before = errors.size();
  KeyReader reader(&table, "lighting." + name, errors);
  std::string type;
  reader.text("type", type, "");
  const LightType known = light_type_of(table, name);
  type = known.name;
  if (type == "tunnel") {
    read_tunnel(reader, name, table, known.is_guessed, scene, errors);
  } else if (std::optional<LightSettings> light = default_light(type)) {
    visit_keys(reader, *light);
    scene.lights.push_back({.name = name, .settings = *std::move(light)});
  } else {
    reader.error(
        table.find("type"),
        "type",
        fmt::format(
            "is \"{}\", must be \"tunnel\", \"{}\"", type, fmt::join(light_types(), "\", \"")),
        Problem::Kind::kOutOfRange);
    return;  // without the type no key can be judged
  }
  reader.report_unknown();
  if (known.is_guessed) {
    explain_guess(std::span(errors).subspan(before));
  }
}

void write_light(ConfigNode& lighting,
                 const std::string& name,
                 auto settings,
                 std::string_view type) {
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, settings);
  table.names.emplace_back("type");
  table.items.push_back(ConfigNode::from_text(std::string(type)));
  lighting.names.push_back(name);
  lighting.items.push_back(std::move(table));
}

}  // namespace

namespace {

bool holds_tables(const ConfigNode& node) {
  return node.is_table() && !node.items.empty() &&
         std::ranges::all_of(node.items, [](const ConfigNode& item) { return item.is_table(); });
}

}  // namespace

void read_lighting(const ConfigNode& root,
                   const std::string& name,
                   SceneSettings& scene,
                   std::vector<Problem>& errors) {
  const SceneSettings plain;
  scene.has_tunnel = plain.has_tunnel;
  scene.tunnel_name = plain.tunnel_name;
  scene.is_tunnel_guessed = plain.is_tunnel_guessed;
  scene.tunnel = plain.tunnel;
  scene.lights.clear();
  const ConfigNode* lighting = root.find(name);
  if (lighting == nullptr) {
    return;
  }
  if (!holds_tables(*lighting)) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = lighting->place,
                      .key = "lighting",
                      .text = "must hold a table for each light, like [lighting.tunnel]"});
    return;
  }
  scene.has_tunnel = false;
  for (std::size_t i = 0; i < lighting->items.size(); ++i) {
    read_light(lighting->items[i], lighting->names[i], scene, errors);
  }
}

ConfigNode write_lighting(const SceneSettings& scene) {
  ConfigNode lighting = ConfigNode::table();
  if (scene.has_tunnel) {
    write_light(lighting, scene.tunnel_name, scene.tunnel, "tunnel");
  }
  for (const NamedLight& light : scene.lights) {
    write_light(lighting, light.name, light.settings, light_type(light.settings));
  }
  return lighting;
}

}  // namespace glint
