// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "studies/definition/render_methods.h"
#include "studies/definition/scene_lights.h"
#include "studies/definition/scene_viewpoints.h"

namespace glint {
namespace {

template <class Settings>
void read_table(const ConfigNode& root,
                const std::string& path,
                Settings& settings,
                std::vector<Problem>& errors) {
  KeyReader reader(root.find(path), path, errors);
  visit_keys(reader, settings);
  reader.report_unknown();
}

/// Reads a table that is one member of the scene, from its defaults.
template <auto Member>
void read_member(const ConfigNode& root,
                 const std::string& name,
                 SceneSettings& scene,
                 std::vector<Problem>& errors) {
  scene.*Member = {};
  read_table(root, name, scene.*Member, errors);
}

/// Reads a table that a scene may be without.
template <auto Member>
void read_optional(const ConfigNode& root,
                   const std::string& name,
                   SceneSettings& scene,
                   std::vector<Problem>& errors) {
  (scene.*Member).reset();
  if (root.find(name) != nullptr) {
    read_table(root, name, (scene.*Member).emplace(), errors);
  }
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
void write_optional(ConfigNode& root,
                    const std::string& name,
                    const std::optional<Settings>& settings) {
  if (settings) {
    write_table(root, name, *settings);
  }
}

template <class Settings>
void list_table(const std::string& path, Settings settings, std::vector<KeyRow>& rows) {
  KeyLister lister(path, rows);
  visit_keys(lister, settings);
}

void read_render(const ConfigNode& root,
                 const std::string& name,
                 SceneSettings& scene,
                 std::vector<Problem>& errors) {
  RenderTable table;
  read_table(root, name, table, errors);
  scene.render = table.render;
  scene.render.reflectance = scene.material.reflectance.front();
  scene.paths = table.paths;
  scene.paths.channels = static_cast<int>(scene.sensor.wavelengths_nm.size());
}

/// [sensor] and how its exposure is found.
struct SensorTable {
  SensorSettings sensor;
  double expose_to = 0.0;
};

void visit_keys(KeyVisitor& keys, SensorTable& table) {
  visit_keys(keys, table.sensor);
  keys.number("expose_to",
              table.expose_to,
              Range::between(0.0, 1.0),
              "sets the exposure so that the 99th percentile of the flawless region is this share "
              "of full scale, so that kinds of light compete alike; 0 = exposure as given");
}

void read_sensor(const ConfigNode& root,
                 const std::string& name,
                 SceneSettings& scene,
                 std::vector<Problem>& errors) {
  SensorTable table;
  read_table(root, name, table, errors);
  scene.sensor = table.sensor;
  scene.expose_to = table.expose_to;
}

bool is_plain_mirror(const MaterialSettings& material) {
  return material.type == MaterialSettings::Type::kMirror && material.nk_file.empty() &&
         material.reflectance.size() == 1 && material.colour_srgb.empty() &&
         material.coat.index == 1.0 && material.texture.is_empty() &&
         material.pattern.kind == PatternSettings::Kind::kNone;
}

/// What of the scene does not go together, without places.
std::vector<Problem> check_level(const SceneSettings& scene) {
  using Method = RenderSettings::Method;
  std::vector<Problem> errors = is_blurred(scene)  ? blurred_problems(scene)
                                : is_direct(scene) ? direct_problems(scene)
                                                   : std::vector<Problem>();
  const auto fail = [&](const char* key, const std::string& text) {
    errors.push_back({.kind = Problem::Kind::kRelation, .key = key, .text = text});
  };
  const Method method = scene.render.method;
  if (needs_paths(scene) && method != Method::kAuto && method != Method::kPaths &&
      method != Method::kDirect) {
    fail("render.method",
         fmt::format("is \"{}\", which is limited to a plain mirror under one tunnel; "
                     "this scene needs \"auto\" or \"paths\"",
                     method_name(method)));
  }
  if (allows_many_viewpoints(scene) || scene.use == SceneUse::kCoverage) {
    return errors;
  }
  if (scene.viewpoints.size() != 1) {
    fail("viewpoint", "a scan has exactly one [[viewpoint]]; position_mm, direction, up");
  }
  if (scene.viewpoint_set.source != ViewpointSource::kListed) {
    fail("viewpoints.source",
         "a scan has the one [[viewpoint]] of the list; allowed is \"listed\"");
  }
  return errors;
}

void read_coverage(const ConfigNode& root,
                   const std::string& table,
                   SceneSettings& scene,
                   std::vector<Problem>& errors) {
  read_member<&SceneSettings::coverage>(root, table, scene, errors);
  scene.has_coverage = root.find(table) != nullptr;
}

void read_defects(const ConfigNode& root,
                  const std::string& table,
                  SceneSettings& scene,
                  std::vector<Problem>& errors) {
  scene.defects.clear();
  const ConfigNode* defects = root.find(table);
  if (defects == nullptr) {
    return;
  }
  if (!defects->is_table()) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = defects->place,
                      .key = "defects",
                      .text = "must hold tables, like [defects.dent]"});
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

/// One of the tables that a scene is read from.
struct SceneTable {
  std::string name;
  void (*read)(const ConfigNode& root,
               const std::string& name,
               SceneSettings& scene,
               std::vector<Problem>& errors);
  std::vector<std::string> follows = {};  ///< tables whose values go into this one's settings
};

/// In the order in which they are read.
const std::vector<SceneTable>& tables_of_scene() {
  using Scene = SceneSettings;
  static const std::vector<SceneTable> tables = {
      {"part", read_member<&Scene::part>},
      {"material", read_member<&Scene::material>},
      {"camera", read_member<&Scene::camera>},
      {"lens", read_member<&Scene::lens>},
      {"calibration", read_optional<&Scene::calibration>},
      {"cell", read_optional<&Scene::cell>},
      {"viewpoint", read_listed_viewpoints, {"part", "camera", "calibration", "cell"}},
      {"viewpoints", read_member<&Scene::viewpoint_set>},
      {"sensor", read_sensor},
      {"scan", read_member<&Scene::scan>},
      {"render", read_render, {"material", "sensor"}},
      {"lighting_use", read_lighting_use},
      {"lighting", read_lighting, {"lighting_use"}},
      {"defects", read_defects},
      {"imprint", read_member<&Scene::imprint>},
      {"metrics", read_member<&Scene::metrics>},
      {"inspection", read_member<&Scene::inspection>},
      {"reference", read_optional<&Scene::reference>},
      {"coverage", read_coverage},
      {"validate", read_optional<&Scene::validate>},
      {"cost", read_cost}};
  return tables;
}

/// Lights are read apart from the key that chooses among them.
void place_lighting_use(const ConfigNode& root, std::vector<Problem>& errors) {
  for (Problem& problem : errors) {
    if (problem.key == "lighting_use") {
      problem = with_place(root, std::move(problem));
    }
  }
}

std::string table_of(const std::string& key) {
  return key.substr(0, key.find('.'));
}

}  // namespace

bool needs_paths(const SceneSettings& scene) {
  return !is_blurred(scene) &&
         (scene.render.method == RenderSettings::Method::kPaths || is_direct(scene) ||
          !scene.has_tunnel || !scene.lights.empty() || !is_plain_mirror(scene.material));
}

bool is_lit(const SceneSettings& scene) {
  return scene.has_tunnel || !scene.lights.empty();
}

bool is_posed(const SceneSettings& scene) {
  const auto is_off = [](double value) { return value != 0.0; };
  return std::ranges::any_of(scene.part.position_mm, is_off) ||
         std::ranges::any_of(scene.part.rotation_rad, is_off);
}

bool allows_many_viewpoints(const SceneSettings& scene) {
  return needs_paths(scene);
}

bool needs_schema_2(const SceneSettings& scene) {
  const auto is_by_flange = [](const Viewpoint& viewpoint) {
    return viewpoint.base_from_flange.has_value();
  };
  return scene.calibration || scene.cell || scene.reference || scene.validate ||
         std::ranges::any_of(scene.viewpoints, is_by_flange);
}

std::vector<std::filesystem::path> input_files(const SceneSettings& scene) {
  std::vector<std::filesystem::path> files = {scene.part.file,
                                              scene.material.nk_file,
                                              scene.material.texture.colour_file,
                                              scene.material.texture.roughness_file};
  if (scene.viewpoint_set.source == ViewpointSource::kFile) {
    files.push_back(scene.viewpoint_set.file);
  }
  if (scene.reference) {
    std::ranges::copy(scene.reference->pictures, std::back_inserter(files));
    std::ranges::copy(scene.reference->masks, std::back_inserter(files));
    files.push_back(scene.reference->calibration);
  }
  if (scene.cell) {
    files.push_back(scene.cell->file);
  }
  for (const std::vector<NamedLight>* lights : {&scene.lights, &scene.idle_lights}) {
    for (const NamedLight& light : *lights) {
      std::visit(
          [&](const auto& settings) {
            if constexpr (requires { settings.file; }) {
              files.push_back(settings.file);
            }
          },
          light.settings);
    }
  }
  std::erase_if(files, [](const std::filesystem::path& file) { return file.empty(); });
  return files;
}

PinholeIntrinsics intrinsics_of(const SceneSettings& scene) {
  return intrinsics_of(scene.camera, scene.lens);
}

const std::vector<std::string>& scene_tables() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    std::ranges::transform(tables_of_scene(), std::back_inserter(all), &SceneTable::name);
    return all;
  }();
  return names;
}

SceneSettings read_scene(const ConfigNode& root, std::vector<Problem>& errors, SceneUse use) {
  SceneSettings scene;
  scene.use = use;
  for (const SceneTable& table : tables_of_scene()) {
    table.read(root, table.name, scene, errors);
  }
  place_lighting_use(root, errors);
  if (errors.empty()) {
    for (const Problem& problem : check_level(scene)) {
      errors.push_back(with_place(root, problem));
    }
  }
  return scene;
}

void reread_scene(const ConfigNode& root,
                  const ConfigNode& changed,
                  SceneSettings& scene,
                  std::vector<Problem>& errors) {
  const auto root_of = [&](const std::string& table) -> const ConfigNode& {
    return changed.find(table) != nullptr ? changed : root;
  };
  const auto is_changed = [&](const std::string& table) { return changed.find(table) != nullptr; };
  for (const SceneTable& table : tables_of_scene()) {
    if (is_changed(table.name) || std::ranges::any_of(table.follows, is_changed)) {
      table.read(root_of(table.name), table.name, scene, errors);
    }
  }
  place_lighting_use(root_of("lighting_use"), errors);
  if (errors.empty()) {
    for (const Problem& problem : check_level(scene)) {
      errors.push_back(with_place(root_of(table_of(problem.key)), problem));
    }
  }
}

ConfigNode write_scene(const SceneSettings& scene) {
  ConfigNode root = ConfigNode::table();
  root.names.emplace_back("lighting_use");
  root.items.push_back(ConfigNode::from_text(scene.lighting_use));
  write_table(root, "part", scene.part);
  write_table(root, "material", scene.material);
  write_table(root, "camera", scene.camera);
  write_table(root, "lens", scene.lens);
  write_optional(root, "calibration", scene.calibration);
  write_optional(root, "cell", scene.cell);
  root.names.emplace_back("viewpoint");
  root.items.push_back(write_listed_viewpoints(scene));
  write_table(root, "viewpoints", scene.viewpoint_set);
  write_table(root, "sensor", SensorTable{.sensor = scene.sensor, .expose_to = scene.expose_to});
  write_table(root, "scan", scene.scan);
  RenderTable render = {.render = scene.render, .paths = scene.paths};
  write_table(root, "render", render);
  root.names.emplace_back("lighting");
  root.items.push_back(write_lighting(scene));
  ConfigNode defects = ConfigNode::table();
  for (const auto& [name, group] : scene.defects) {
    write_table(defects, name, group);
  }
  root.names.emplace_back("defects");
  root.items.push_back(std::move(defects));
  write_table(root, "imprint", scene.imprint);
  write_table(root, "metrics", scene.metrics);
  write_table(root, "inspection", scene.inspection);
  write_optional(root, "reference", scene.reference);
  write_optional(root, "validate", scene.validate);
  if (scene.has_coverage) {
    write_table(root, "coverage", scene.coverage);
  }
  write_optional(root, "cost", scene.cost);
  return root;
}

std::vector<KeyRow> scene_keys() {
  std::vector<KeyRow> rows;
  list_table("part", PartSettings{}, rows);
  list_table("material", MaterialSettings{}, rows);
  list_table("camera", CameraSettings{}, rows);
  list_table("lens", LensSettings{}, rows);
  list_table("calibration", CalibrationSettings{}, rows);
  list_table("cell", CellSettings{}, rows);
  std::ranges::move(listed_viewpoint_keys(), std::back_inserter(rows));
  list_table("viewpoints", ViewpointSettings{}, rows);
  list_table("sensor", SensorTable{}, rows);
  list_table("scan", ScanSettings{}, rows);
  RenderTable render;
  render.paths.has_bias_taken_off = true;  // else the key is not listed
  list_table("render", std::move(render), rows);
  std::ranges::find(rows, "render.paths.debias", &KeyRow::path)->default_text = "false";
  rows.push_back(lighting_use_key());
  list_table("lighting.tunnel", TunnelSettings{}, rows);
  for (const std::string_view type : light_types()) {
    list_table(fmt::format("lighting.{}", type), default_light(type).value(), rows);
  }
  list_table("defects.dent", DefectGroup{}, rows);
  list_table("imprint", ImprintSettings{}, rows);
  list_table("metrics", MetricsSettings{}, rows);
  list_table("inspection", InspectionSettings{}, rows);
  list_table("reference", ReferenceSettings{}, rows);
  list_table("validate", ValidateSettings{}, rows);
  list_table("coverage", CoverageSettings{}, rows);
  std::ranges::move(cost_keys(), std::back_inserter(rows));
  return rows;
}

Problem with_place(const ConfigNode& root, Problem problem) {
  std::string key = problem.key;
  const bool is_of_scene = std::ranges::find(scene_tables(), table_of(key)) != scene_tables().end();
  if (!problem.place.file.empty() || !is_of_scene) {
    return problem;
  }
  problem.place = {.file = root.place.file};
  while (!key.empty()) {
    const ConfigNode* node = root.at_path(key);
    if (node != nullptr && !node->place.file.empty()) {
      problem.place = node->place;
      break;
    }
    // The key may have kept its default; then the table around it, or the file, is the place.
    const auto dot = key.rfind('.');
    key = dot == std::string::npos ? "" : key.substr(0, dot);
  }
  return problem;
}

ConfigError with_place(const ConfigNode& root, const ConfigError& error) {
  std::vector<Problem> problems = error.problems();
  for (Problem& problem : problems) {
    problem = with_place(root, std::move(problem));
  }
  return ConfigError(std::move(problems));
}

ConfigError in_context(const ConfigError& error, const std::string& context) {
  std::vector<Problem> problems = error.problems();
  for (Problem& problem : problems) {
    problem.context = context + (problem.context.empty() ? "" : ": " + problem.context);
  }
  return ConfigError(std::move(problems));
}

}  // namespace glint
