// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene_lights.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"

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
    problem.text += fmt::format(R"(; no type, so it is read as a tunnel; types are "tunnel", "{}")",
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
        fmt::format(R"(is "{}", must be "tunnel", "{}")", type, fmt::join(light_types(), "\", \"")),
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

/// What a name in lighting_use may be.
std::vector<std::string> light_names(const SceneSettings& scene) {
  std::vector<std::string> names;
  if (scene.has_tunnel) {
    names.push_back(scene.tunnel_name);
  }
  std::ranges::transform(scene.lights, std::back_inserter(names), &NamedLight::name);
  return names;
}

/// What is wrong with a set of names; empty when nothing is.
std::string use_problem(const std::vector<std::string>& used,
                        const std::vector<std::string>& known) {
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (std::ranges::find(known, used[i]) == known.end()) {
      return fmt::format(R"("{}" is no light; allowed are "all" and sets of {} like "{}")",
                         used[i],
                         fmt::join(known, ", "),
                         fmt::join(known, "+"));
    }
    if (std::find(used.begin(), used.begin() + static_cast<std::ptrdiff_t>(i), used[i]) !=
        used.begin() + static_cast<std::ptrdiff_t>(i)) {
      return fmt::format("names \"{}\" twice", used[i]);
    }
  }
  return "";
}

/// Puts the lights that lighting_use leaves out apart. Who knows the file gives problems their
/// place.
void select_lights(SceneSettings& scene, std::vector<Problem>& errors) {
  if (scene.lighting_use == "all") {
    return;
  }
  const std::vector<std::string> used = split(scene.lighting_use, '+');
  if (const std::string text = use_problem(used, light_names(scene)); !text.empty()) {
    errors.push_back({.kind = Problem::Kind::kOutOfRange, .key = "lighting_use", .text = text});
    return;
  }
  const auto is_idle = [&](const std::string& name) {
    return std::ranges::find(used, name) == used.end();
  };
  scene.has_idle_tunnel = scene.has_tunnel && is_idle(scene.tunnel_name);
  scene.has_tunnel = scene.has_tunnel && !scene.has_idle_tunnel;
  std::vector<NamedLight> shining;
  for (NamedLight& light : scene.lights) {
    (is_idle(light.name) ? scene.idle_lights : shining).push_back(std::move(light));
  }
  scene.lights = std::move(shining);
}

}  // namespace

void read_lighting_use(const ConfigNode& root,
                       const std::string& name,
                       SceneSettings& scene,
                       std::vector<Problem>& errors) {
  scene.lighting_use = "all";
  const ConfigNode* use = root.find(name);
  if (use == nullptr) {
    return;
  }
  if (use->kind != ConfigNode::Kind::kText || use->text.empty()) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = use->place,
                      .key = name,
                      .text = R"(must be "all" or names of lights like "ring+dome")"});
    return;
  }
  scene.lighting_use = use->text;
}

KeyRow lighting_use_key() {
  return {.path = "lighting_use",
          .kind = "text",
          .allowed = R"("all", or names of tables below [lighting] like "ring+dome")",
          .default_text = "\"all\"",
          .doc = "which lights shine; the others are checked and not built"};
}

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
  scene.has_idle_tunnel = false;
  scene.idle_lights.clear();
  const ConfigNode* lighting = root.find(name);
  if (lighting == nullptr) {
    select_lights(scene, errors);
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
  select_lights(scene, errors);
}

ConfigNode write_lighting(const SceneSettings& scene) {
  ConfigNode lighting = ConfigNode::table();
  if (scene.has_tunnel || scene.has_idle_tunnel) {
    write_light(lighting, scene.tunnel_name, scene.tunnel, "tunnel");
  }
  for (const std::vector<NamedLight>* lights : {&scene.lights, &scene.idle_lights}) {
    for (const NamedLight& light : *lights) {
      write_light(lighting, light.name, light.settings, light_type(light.settings));
    }
  }
  return lighting;
}

SceneSettings with_idle_lights(SceneSettings scene) {
  std::ranges::move(scene.idle_lights, std::back_inserter(scene.lights));
  scene.idle_lights.clear();
  if (scene.has_idle_tunnel) {
    scene.has_tunnel = true;
    scene.has_idle_tunnel = false;
    scene.scan = {.positions = 1, .step_mm = 1.0};
    scene.tunnel.led_ripple = 0.0;
    scene.tunnel.end_falloff = 0.0;
  }
  return scene;
}

void check_lights_go_along(const SceneSettings& scene) {
  const SceneSettings all = with_idle_lights(scene);
  for (const NamedLight& light : all.lights) {
    if (!is_surrounding(light.settings) &&
        mount_of(light.settings) == LightPlacement::Mount::kScene) {
      throw ConfigError(
          fmt::format("lighting.{}.mount", light.name),
          "is \"scene\", and the flange holds the scene with its part: must be \"camera\" of a "
          "light that stands beside the camera, \"part\" of one that goes along with the part");
    }
  }
  if (all.has_tunnel) {
    throw ConfigError("lighting." + scene.tunnel_name,
                      "is a tunnel, which stands in the scene, and the flange holds the scene "
                      "with its part: it cannot be planned for");
  }
}

namespace {

/// The settings with a value for every key, of the smallest range that all allow.
CostSettings with_every_key() {
  return {.exposure_s = 1.0, .move_s = 0.0, .per_mm2 = 0.0, .per_led = 0.0, .per_frame = 0.0};
}

}  // namespace

void visit_keys(KeyVisitor& keys, CostSettings& s) {
  const auto visit = [&](std::string_view key,
                         std::optional<double>& value,
                         const Range& range,
                         std::string_view doc) {
    if (value) {
      keys.number(key, *value, range, doc);
    }
  };
  const Range price = Range::at_least(0);
  visit("exposure_ms", s.exposure_s, Range::positive(), "of one picture, for scan.time_s");
  visit("move_ms",
        s.move_s,
        Range::at_least(0),
        "from one position of a scan to the next, until it stands still, for scan.time_s");
  visit("per_mm2", s.per_mm2, price, "price of 1 mm2 of luminous surface, in any unit of money");
  visit("per_led", s.per_led, price, "price of a single LED, in the same unit");
  visit("per_frame", s.per_frame, price, "price of a picture of the scan, in the same unit");
}

void read_cost(const ConfigNode& root,
               const std::string& name,
               SceneSettings& scene,
               std::vector<Problem>& errors) {
  scene.cost.reset();
  const ConfigNode* table = root.find(name);
  if (table == nullptr) {
    return;
  }
  CostSettings settings = with_every_key();
  KeyReader reader(table, name, errors);
  visit_keys(reader, settings);
  reader.report_unknown();
  const auto forget_absent = [&](std::string_view key, std::optional<double>& value) {
    if (!reader.is_given(key)) {
      value.reset();
    }
  };
  forget_absent("exposure_ms", settings.exposure_s);
  forget_absent("move_ms", settings.move_s);
  forget_absent("per_mm2", settings.per_mm2);
  forget_absent("per_led", settings.per_led);
  forget_absent("per_frame", settings.per_frame);
  scene.cost = settings;
}

std::vector<KeyRow> cost_keys() {
  CostSettings settings = with_every_key();
  std::vector<KeyRow> rows;
  KeyLister lister("cost", rows);
  visit_keys(lister, settings);
  for (KeyRow& row : rows) {
    row.default_text = "none";
    if (row.path == "cost.per_mm2") {
      row.unit.clear();  // money over mm2
    }
  }
  return rows;
}

}  // namespace glint
