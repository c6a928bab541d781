// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/viewpoint_file.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/config/located_json.h"
#include "core/config/toml.h"
#include "core/csv.h"
#include "core/file.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 9> kColumns = {"position_x_mm",
                                                      "position_y_mm",
                                                      "position_z_mm",
                                                      "direction_x",
                                                      "direction_y",
                                                      "direction_z",
                                                      "up_x",
                                                      "up_y",
                                                      "up_z"};

/// Divides by the length; a vector that is a unit to rounding stays as it is, so that writing and
/// reading again is stable.
void make_unit(std::vector<double>& values) {
  const double length = Eigen::Vector3d(values[0], values[1], values[2]).stableNorm();
  if (std::abs(length - 1.0) < 1e-15) {
    return;
  }
  for (double& value : values) {
    value /= length;
  }
}

/// Nine numbers as the table that visit_keys() reads; anything else is returned as it is.
ConfigNode as_table(const ConfigNode& item) {
  if (!item.is_array()) {
    return item;
  }
  ConfigNode table = ConfigNode::table();
  table.place = item.place;
  const std::array<const char*, 3> names = {"position_mm", "direction", "up"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    ConfigNode part = ConfigNode::array();
    for (std::size_t k = 0; k < 3; ++k) {
      part.items.push_back(item.items[3 * i + k]);
    }
    part.place = part.items.front().place;
    table.names.emplace_back(names[i]);
    table.items.push_back(std::move(part));
  }
  return table;
}

ConfigNode row_node(const CsvRow& row) {
  ConfigNode node = ConfigNode::array();
  node.place = row.front().place;
  for (const CsvField& field : row) {
    const std::optional<double> number = field.number();
    node.items.push_back(number ? ConfigNode::from_number(*number)
                                : ConfigNode::from_text(field.text));
    node.items.back().place = field.place;
  }
  return node;
}

bool is_head(const ConfigNode& row) {
  return std::all_of(row.items.begin(), row.items.end(), [](const ConfigNode& field) {
    return field.kind == ConfigNode::Kind::kText && !field.text.empty();
  });
}

void check_head(const ConfigNode& row) {
  for (std::size_t i = 0; i < std::max(row.items.size(), kColumns.size()); ++i) {
    if (i >= row.items.size()) {
      throw ConfigError(fmt::format("{}the head line lacks the column {}; columns are {}",
                                    row.place.prefix(),
                                    kColumns[i],
                                    fmt::join(kColumns, ",")));
    }
    if (i >= kColumns.size() || row.items[i].text != kColumns[i]) {
      throw ConfigError(fmt::format("{}column '{}' is not known here; columns are {}",
                                    row.items[i].place.prefix(),
                                    row.items[i].text,
                                    fmt::join(kColumns, ",")));
    }
  }
}

std::vector<Viewpoint> checked_list(const ConfigNode& list) {
  std::vector<Problem> errors;
  std::vector<Viewpoint> viewpoints = read_viewpoint_list(list, errors);
  if (errors.empty() && viewpoints.empty()) {
    errors.push_back(
        {.place = list.place, .key = "viewpoint", .text = "there is none, at least one is needed"});
  }
  throw_if_any(errors);
  return viewpoints;
}

const ConfigNode& list_of(const ConfigNode& root) {
  const ConfigNode* list = root.is_array() ? &root : root.find("viewpoint");
  if (list == nullptr) {
    throw ConfigError(root.place.prefix() + "viewpoint: missing, must be a list of viewpoints");
  }
  return *list;
}

}  // namespace

ViewpointVector vector_of(const Viewpoint& viewpoint) {
  ViewpointVector vector;
  for (std::size_t i = 0; i < 3; ++i) {
    vector[i] = viewpoint.position_mm[i];
    vector[3 + i] = viewpoint.direction[i];
    vector[6 + i] = viewpoint.up[i];
  }
  return vector;
}

Viewpoint normalised(const Viewpoint& viewpoint) {
  const ViewpointVector vector = vector_of(viewpoint);
  if (!std::all_of(vector.begin(), vector.end(), [](double v) { return std::isfinite(v); })) {
    throw ConfigError("viewpoint", "a number is not finite, all nine must be");
  }
  Viewpoint result = viewpoint;
  make_unit(result.direction);
  make_unit(result.up);
  const Eigen::Vector3d direction(result.direction[0], result.direction[1], result.direction[2]);
  const Eigen::Vector3d up(result.up[0], result.up[1], result.up[2]);
  if (!(direction.cross(up).norm() > 1e-10)) {  // also when a vector was zero, now NaN
    throw ConfigError("viewpoint.up", "must not be zero or parallel to direction");
  }
  return result;
}

std::vector<Viewpoint> read_viewpoint_list(const ConfigNode& list, std::vector<Problem>& errors) {
  std::vector<Viewpoint> viewpoints;
  if (!list.is_array()) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = list.place,
                      .key = "viewpoint",
                      .text = "must be a list of viewpoints"});
    return viewpoints;
  }
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const ConfigNode& item = list.items[i];
    const std::string path = fmt::format("viewpoint.{}", i);
    if (!(item.is_array() ? item.items.size() == 9 : item.is_table())) {
      errors.push_back(
          {.kind = Problem::Kind::kWrongType,
           .place = item.place,
           .key = path,
           .text = fmt::format(
               "{}, must have nine numbers: position_mm, direction, up",
               item.is_array() ? fmt::format("has {}", item.items.size()) : "is a single value")});
      continue;
    }
    const ConfigNode table = as_table(item);
    const std::size_t errors_before = errors.size();
    Viewpoint viewpoint;
    KeyReader reader(&table, path, errors);
    visit_keys(reader, viewpoint);
    reader.report_unknown();
    if (errors.size() == errors_before) {
      viewpoints.push_back(normalised(viewpoint));
    }
  }
  return viewpoints;
}

std::vector<Viewpoint> parse_viewpoints_csv(std::string_view text, const std::string& file) {
  ConfigNode list = ConfigNode::array();
  list.place = {.file = file, .line = 1, .column = 1};
  for (const CsvRow& row : parse_csv(text, file, '#')) {
    list.items.push_back(row_node(row));
  }
  if (!list.items.empty() && is_head(list.items.front())) {
    check_head(list.items.front());
    list.items.erase(list.items.begin());
  }
  return checked_list(list);
}

std::vector<Viewpoint> parse_viewpoints_json(std::string_view text, const std::string& file) {
  return checked_list(list_of(parse_located_json(text, file)));
}

std::vector<Viewpoint> read_viewpoints(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".toml") {
    return checked_list(list_of(load_toml(path)));
  }
  if (ending == ".csv") {
    return parse_viewpoints_csv(read_file(path), path.string());
  }
  if (ending == ".json") {
    return parse_viewpoints_json(read_file(path), path.string());
  }
  throw ConfigError(
      "viewpoints.file",
      fmt::format("'{}' ends in '{}', must be .toml, .csv or .json", path.string(), ending));
}

}  // namespace glint
