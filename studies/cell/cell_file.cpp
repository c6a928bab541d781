// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/cell_file.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "core/config/toml.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 2> kLightKinds = {"digital_output", "manual"};
constexpr auto kTables = std::to_array<std::string_view>({"camera",
                                                          "robot",
                                                          "limits",
                                                          "lights",
                                                          "stage",
                                                          "acquisition",
                                                          "calibration",
                                                          "twin",
                                                          "safe_position",
                                                          "view",
                                                          "planning",
                                                          "obstacle",
                                                          "body"});

Problem wrong_type(const ConfigNode& node, std::string_view key, std::string text) {
  return {.kind = Problem::Kind::kWrongType,
          .place = node.place,
          .key = std::string(key),
          .text = std::move(text)};
}

/// [camera.features]: any names; values as text.
std::vector<CellFeature> read_features(KeyReader& reader, std::vector<Problem>& errors) {
  std::vector<CellFeature> features;
  const ConfigNode* table = reader.take("features");
  if (table == nullptr) {
    return features;
  }
  if (!table->is_table()) {
    errors.push_back(wrong_type(*table, "camera.features", "must be a table: [camera.features]"));
    return features;
  }
  for (std::size_t i = 0; i < table->names.size(); ++i) {
    const ConfigNode& value = table->items[i];
    if (value.is_table() || value.is_array()) {
      errors.push_back(wrong_type(
          value, "camera.features." + table->names[i], "must be a number, a text, true or false"));
      continue;
    }
    features.push_back(
        {.name = table->names[i],
         .value = value.kind == ConfigNode::Kind::kText ? value.text : value_to_toml(value)});
  }
  return features;
}

template <class Settings>
std::optional<Settings> read_table(const ConfigNode& root,
                                   std::string_view name,
                                   std::vector<Problem>& errors) {
  const ConfigNode* table = root.find(name);
  if (table == nullptr) {
    return std::nullopt;
  }
  if (!table->is_table()) {
    errors.push_back(wrong_type(*table, name, fmt::format("must be a table: [{}]", name)));
    return std::nullopt;
  }
  Settings settings;
  KeyReader reader(table, std::string(name), errors);
  visit_keys(reader, settings);
  if constexpr (requires { settings.features; }) {
    settings.features = read_features(reader, errors);
  }
  reader.report_unknown();
  return settings;
}

std::vector<CellLight> read_lights(const ConfigNode& root, std::vector<Problem>& errors) {
  std::vector<CellLight> lights;
  const ConfigNode* tables = root.find("lights");
  if (tables == nullptr) {
    return lights;
  }
  if (!tables->is_table()) {
    errors.push_back(wrong_type(*tables, "lights", "must hold tables, like [lights.ring]"));
    return lights;
  }
  for (std::size_t i = 0; i < tables->names.size(); ++i) {
    CellLight light = {.name = tables->names[i]};
    KeyReader reader(&tables->items[i], "lights." + light.name, errors);
    visit_keys(reader, light);
    const ConfigNode* output = tables->items[i].find("output");
    light.output_place = output != nullptr ? output->place : tables->items[i].place;
    reader.report_unknown();
    lights.push_back(light);
  }
  return lights;
}

std::vector<std::string> read_texts(KeyReader& reader, std::string_view key) {
  std::vector<std::string> texts;
  const ConfigNode* list = reader.take(key);
  if (list == nullptr) {
    return texts;
  }
  const bool are_texts =
      list->is_array() && std::ranges::all_of(list->items, [](const ConfigNode& item) {
        return item.kind == ConfigNode::Kind::kText;
      });
  if (!are_texts) {
    reader.error(list, key, "must be a list of names", Problem::Kind::kWrongType);
    return texts;
  }
  std::ranges::transform(list->items, std::back_inserter(texts), &ConfigNode::text);
  return texts;
}

CellPosition read_position(const ConfigNode& table,
                           const std::string& path,
                           bool is_view,
                           std::vector<Problem>& errors) {
  CellPosition position = {.place = table.place};
  KeyReader reader(&table, path, errors);
  reader.text("name", position.name, "of the position");
  reader.numbers("joints_deg",
                 position.joints_rad,
                 {.min = 6, .max = 6},
                 Range::between(-360, 360),
                 "angles of the joints from the base to the flange");
  reader.require(reader.is_given("joints_deg"), "joints_deg", "is missing: six angles");
  if (is_view) {
    position.lights = read_texts(reader, "lights");
    if (reader.is_given("exposure_us")) {
      double exposure_s = 0.0;
      reader.number("exposure_us", exposure_s, Range::positive(), "of pictures from here");
      position.exposure_s = exposure_s;
    }
  }
  reader.report_unknown();
  return position;
}

std::vector<CellPosition> read_positions(const ConfigNode& root,
                                         const std::string& name,
                                         bool is_view,
                                         std::vector<Problem>& errors) {
  std::vector<CellPosition> positions;
  const ConfigNode* list = root.find(name);
  if (list == nullptr) {
    return positions;
  }
  if (!list->is_array()) {
    errors.push_back(wrong_type(*list, name, fmt::format("must be one or more [[{}]]", name)));
    return positions;
  }
  for (std::size_t i = 0; i < list->items.size(); ++i) {
    const std::string path = fmt::format("{}.{}", name, i + 1);
    positions.push_back(read_position(list->items[i], path, is_view, errors));
  }
  return positions;
}

void read_calibration(const ConfigNode& root, Cell& cell, std::vector<Problem>& errors) {
  KeyReader reader(root.find("calibration"), "calibration", errors);
  reader.file("file", cell.calibration, "calibration.toml, as glint calibrate wrote it");
  reader.report_unknown();
}

void read_twin(const ConfigNode& root, Cell& cell, std::vector<Problem>& errors) {
  KeyReader reader(root.find("twin"), "twin", errors);
  reader.file("truth", cell.truth, "scene with a table [truth] that the camera's twin renders");
  reader.number("motion_speedup",
                cell.motion_speedup,
                Range::between(0.1, 100),
                "how much faster than real time the robot's twin moves");
  reader.report_unknown();
}

void check_tables(const ConfigNode& root, std::vector<Problem>& errors) {
  for (std::size_t i = 0; i < root.names.size(); ++i) {
    if (std::ranges::find(kTables, std::string_view(root.names[i])) == kTables.end()) {
      errors.push_back({.kind = Problem::Kind::kUnknownKey,
                        .place = root.items[i].place,
                        .key = root.names[i],
                        .text = "is no table of a cell; there are " + quoted_list(kTables)});
    }
  }
}

void check_relations(const ConfigNode& root, const Cell& cell, std::vector<Problem>& errors) {
  const auto problem = [&errors](const Place& place, std::string key, std::string text) {
    errors.push_back({.kind = Problem::Kind::kRelation,
                      .place = place,
                      .key = std::move(key),
                      .text = std::move(text)});
  };
  if (!cell.camera && !cell.robot && errors.empty()) {
    problem({.file = cell.file.string()}, "", "a cell needs a table [camera] or [robot]");
  }
  if (cell.robot && root.find("limits") == nullptr) {
    problem(root.find("robot")->place,
            "limits",
            "is missing: a robot needs a table [limits] with speeds and a box");
  }
  if (cell.robot && cell.safe_positions.empty()) {
    problem(root.find("robot")->place, "safe_position", "is missing: a robot needs one or more");
  }
  for (const CellPosition& view : cell.views) {
    for (const std::string& light : view.lights) {
      if (std::ranges::find(cell.lights, light, &CellLight::name) == cell.lights.end()) {
        problem(view.place, "view.lights", fmt::format("there is no table [lights.{}]", light));
      }
    }
  }
}

const CellPosition& position_named(const std::vector<CellPosition>& positions,
                                   const std::string& name,
                                   const std::string& kind) {
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const auto found = std::ranges::find(positions, name, &CellPosition::name);
  if (found != positions.end() && !name.empty()) {
    return *found;
  }
  if (error == std::errc() && end == name.data() + name.size() && number >= 1 &&
      number <= static_cast<int>(positions.size())) {
    return positions[static_cast<std::size_t>(number) - 1];
  }
  throw ConfigError(fmt::format(
      "{} \"{}\": is none of the cell's; there are 1 to {}", kind, name, positions.size()));
}

}  // namespace

namespace {

void visit_gain(KeyVisitor& keys, CellCamera& camera) {
  double gain_db = 0.0;
  double gain_raw = 0.0;
  keys.number("gain_db", gain_db, Range::between(0, 60), "of pictures; without it as it is");
  keys.number("gain_raw",
              gain_raw,
              Range::at_least(0),
              "the same, of a camera whose gain is in steps of its own");
  camera.gain_db = keys.is_given("gain_db") ? std::optional(gain_db) : std::nullopt;
  camera.gain_raw = keys.is_given("gain_raw") ? std::optional(gain_raw) : std::nullopt;
  keys.require(!camera.gain_db || !camera.gain_raw, "gain_raw", "must not be given beside gain_db");
}

}  // namespace

void visit_keys(KeyVisitor& keys, CellCamera& camera) {
  keys.text("id", camera.id, "vendor, model and serial number, as glint cell list names them");
  keys.text("address", camera.address, "IPv4 address");
  keys.choice("pixel_format", camera.pixel_format, kCellPixelFormats, "of pictures");
  keys.number("exposure_us",
              camera.exposure_s,
              {.min = 0.0, .max = 60e6, .min_excluded = true},
              "of pictures where a view has no other");
  visit_gain(keys, camera);
  keys.integer("packet_bytes",
               camera.packet_bytes,
               Range::between(0, 65535),
               "of the network; 0: as large as a test packet gets through");
  keys.numbers("region_px",
               camera.region_px,
               {.min = 4, .max = 4},
               Range::between(0, 100000),
               "x, y, width and height on the sensor; without it all of it");
}

void visit_keys(KeyVisitor& keys, CellLight& light) {
  keys.choice("kind", light.kind, kLightKinds, "what switches it");
  keys.integer("output", light.output, Range::between(0, 7), "standard digital output");
  keys.number("settle_s", light.settle_s, Range::between(0, 60), "until it shines evenly");
}

Cell read_cell(const std::filesystem::path& path) {
  const ConfigNode root = load_toml(path);
  std::vector<Problem> errors;
  Cell cell = {.file = path};
  check_tables(root, errors);
  cell.camera = read_table<CellCamera>(root, "camera", errors);
  cell.robot = read_table<UrSettings>(root, "robot", errors);
  cell.limits = read_table<MotionLimits>(root, "limits", errors).value_or(MotionLimits{});
  cell.lights = read_lights(root, errors);
  cell.stage = read_table<CellStage>(root, "stage", errors);
  cell.acquisition =
      read_table<PictureLimits>(root, "acquisition", errors).value_or(PictureLimits{});
  read_calibration(root, cell, errors);
  read_twin(root, cell, errors);
  cell.safe_positions = read_positions(root, "safe_position", false, errors);
  cell.views = read_positions(root, "view", true, errors);
  cell.planning = read_cell_planning(root, errors);
  check_relations(root, cell, errors);
  throw_if_any(errors);
  return cell;
}

std::vector<Problem> shared_outputs(const Cell& cell) {
  std::vector<Problem> problems;
  for (auto light = cell.lights.begin(); light != cell.lights.end(); ++light) {
    const auto same = std::find_if(cell.lights.begin(), light, [&light](const CellLight& other) {
      return other.kind == light->kind && other.output == light->output;
    });
    if (light->kind == CellLight::Kind::kManual || same == light) {
      continue;
    }
    problems.push_back(
        {.kind = Problem::Kind::kRelation,
         .place = light->output_place,
         .key = fmt::format("lights.{}.output", light->name),
         .text = fmt::format("is {}, as that of lights.{}, which would be switched with it; each "
                             "light needs an output of its own, from 0 to 7",
                             light->output,
                             same->name)});
  }
  return problems;
}

std::string cell_name(const std::filesystem::path& file) {
  return std::filesystem::absolute(file).parent_path().filename().string();
}

const UrSettings& robot_of(const Cell& cell) {
  if (!cell.robot) {
    throw ConfigError(fmt::format("{}: robot: the cell has no robot", cell.file.string()));
  }
  return *cell.robot;
}

const CellCamera& camera_of(const Cell& cell) {
  if (!cell.camera) {
    throw ConfigError(fmt::format("{}: camera: the cell has no camera", cell.file.string()));
  }
  return *cell.camera;
}

const CellPosition& view_of(const Cell& cell, const std::string& name) {
  return position_named(cell.views, name, "view");
}

const CellPosition& safe_position_of(const Cell& cell, const std::string& name) {
  return position_named(cell.safe_positions, name.empty() ? "1" : name, "safe position");
}

}  // namespace glint
