// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/study_schema.h"

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/definition/key_table.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// Stands in a path for any name of the user's, as in sorting.sources.<name>.share.
constexpr std::string_view kAnyName = "<name>";

Json number_schema(std::string_view type, const Range& range) {
  Json schema = {{"type", type}};
  if (std::isfinite(range.min)) {
    schema[range.min_excluded ? "exclusiveMinimum" : "minimum"] = range.min;
  }
  if (std::isfinite(range.max)) {
    schema["maximum"] = range.max;
  }
  return schema;
}

Json array_schema(const Json& items, const Count& count) {
  Json schema = {{"type", "array"}, {"items", items}, {"minItems", count.min}};
  if (count.max != Count{}.max) {
    schema["maxItems"] = count.max;
  }
  return schema;
}

Json new_table() {
  return {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
}

/// "auto", or how wrong each score may be.
Json tolerance_schema() {
  const Json text = {{"type", "string"}, {"pattern", "^[0-9.eE+-]+ *(%|points?)$"}};
  const Json wish = {{"anyOf", {number_schema("number", Range::positive()), text}}};
  return {{"anyOf",
           {{{"enum", {"auto"}}},
            {{"type", "object"}, {"minProperties", 1}, {"additionalProperties", wish}}}}};
}

/// What a value may be.
Json value_schema(const KeyRow& row) {
  if (row.kind == "number" || row.kind == "integer") {
    return number_schema(row.kind, row.range);
  }
  const Json number = number_schema("number", row.range);
  if (row.kind == "numbers") {
    return array_schema(number, row.count);
  }
  if (row.kind == "interval") {
    return {{"anyOf", {number, array_schema(number, {.min = 2, .max = 2})}}};
  }
  if (row.kind == "choice") {
    return {{"enum", row.choices}};
  }
  if (row.kind == "table") {
    return new_table();
  }
  if (row.kind == "tolerance") {
    return tolerance_schema();
  }
  if (row.kind == "texts") {
    return array_schema({{"type", "string"}}, {});
  }
  return {{"type", row.kind == "boolean" ? "boolean" : "string"}};
}

Json key_schema(const KeyRow& row) {
  Json schema = value_schema(row);
  schema["description"] =
      row.unit.empty() ? row.doc : fmt::format("{} [{}; {}]", row.doc, row.unit, row.allowed);
  const Json written = Json::parse(row.default_text, nullptr, false);
  if (!written.is_discarded()) {
    schema["default"] = written;
  }
  return schema;
}

/// The table below another one that a part of a path means, made where there is none yet.
Json& table_below(Json& table, const std::string& part) {
  Json& below = part == kAnyName ? table["additionalProperties"] : table["properties"][part];
  if (!below.is_object()) {
    below = new_table();
  }
  return below;
}

void add_key(Json& root, const KeyRow& row) {
  std::vector<std::string> parts = split(row.path, '.');
  Json* table = &root;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    if (parts[i] == "viewpoint") {  // its tables form a list; the number of one follows
      Json& list = (*table)["properties"][parts[i]];
      if (!list.is_object()) {
        list = {{"type", "array"}, {"minItems", 1}, {"items", new_table()}};
      }
      table = &list["items"];
      ++i;
    } else {
      table = &table_below(*table, parts[i]);
    }
  }
  (*table)["properties"][parts.back()] = key_schema(row);
}

std::string definition(const std::string& type) {
  return "#/definitions/" + type;
}

/// A table whose name is a type of light may say another type; one of any other name is a tunnel
/// unless it says so.
void add_lighting(Json& root, const std::vector<std::string>& types) {
  Json of_given_type = Json::array();
  for (const std::string& type : types) {
    of_given_type.push_back({{"allOf", {{{"$ref", definition(type)}}, {{"required", {"type"}}}}}});
  }
  root["definitions"]["light"] = {{"anyOf", of_given_type}};
  const auto light_named = [&](const std::string& name) {
    return Json{{"anyOf", {{{"$ref", definition(name)}}, {{"$ref", definition("light")}}}}};
  };
  Json& lighting = root["properties"]["lighting"];
  lighting = new_table();
  lighting["minProperties"] = 1;
  for (const std::string& type : types) {
    lighting["properties"][type] = light_named(type);
  }
  lighting["additionalProperties"] = light_named("tunnel");
}

/// Lights have a definition for each type.
void add_light_key(Json& root, KeyRow row, std::vector<std::string>& types) {
  const std::vector<std::string> parts = split(row.path, '.');
  const std::string& type = parts.at(1);
  Json& table = root["definitions"][type];
  if (!table.is_object()) {
    table = new_table();
    types.push_back(type);
  }
  if (row.path.ends_with(".type") && parts.size() == 3) {
    row.choices = {type};
  }
  row.path = row.path.substr(std::string("lighting.").size() + type.size() + 1);
  add_key(table, row);
}

/// Tables that hold paths of keys and names of scores.
void add_study_tables(Json& root) {
  const Json number = {{"type", "number"}};
  const Json text = {{"type", "string"}};
  Json variable = new_table();
  variable["properties"] = {{"min", number},
                            {"max", number},
                            {"step", number},
                            {"log", {{"type", "boolean"}}},
                            {"choices", {{"type", "array"}, {"minItems", 1}}},
                            {"when", text}};
  Json limits = new_table();
  limits["properties"] = {
      {"min", number}, {"max", number}, {"weight", number_schema("number", Range::positive())}};
  limits["anyOf"] = {{{"required", {"min"}}}, {{"required", {"max"}}}};
  Json objective = new_table();
  objective["properties"] = {{"maximise", text}, {"minimise", text}};
  objective["minProperties"] = 1;
  objective["maxProperties"] = 1;
  Json listed = new_table();
  listed["properties"] = {{"maximise", text},
                          {"minimise", text},
                          {"reference", number},
                          {"aspiration", number},
                          {"weight", number_schema("number", Range::positive())}};
  listed["oneOf"] = {{{"required", {"maximise"}}}, {{"required", {"minimise"}}}};
  const auto tables_of = [](const Json& table) {
    return Json{{"type", "object"}, {"additionalProperties", table}};
  };
  Json& tables = root["properties"];
  tables["variables"] = tables_of(variable);
  tables["prototypes"] = tables_of({{"type", "object"}, {"properties", {{"title", text}}}});
  Json tolerance = new_table();
  tolerance["properties"] = {{"plus_minus", number_schema("number", Range::positive())}};
  tolerance["required"] = {"plus_minus"};
  tables["manufacture"] = tables_of(tolerance);
  tables["objective"] = {
      {"anyOf", {objective, {{"type", "array"}, {"minItems", 2}, {"items", listed}}}}};
  tables["constraints"] = tables_of(limits);
}

/// Tables of defects have names of the user's: rows show the keys of one.
std::string schema_path(const std::string& path) {
  const std::string shown = "defects.dent.";
  return path.starts_with(shown) ? fmt::format("defects.{}.{}", kAnyName, path.substr(shown.size()))
                                 : path;
}

bool is_of_study_tables(const std::string& path) {
  return path.find('"') != std::string::npos || path.starts_with("objective.");
}

}  // namespace

Json study_schema() {
  Json root = {{"$schema", "http://json-schema.org/draft-07/schema#"},
               {"title", "Glint study"},
               {"type", "object"},
               {"additionalProperties", false},
               {"properties", Json::object()},
               {"definitions", Json::object()}};
  std::vector<std::string> light_kinds;
  for (KeyRow row : all_keys()) {
    if (row.path.starts_with("lighting.")) {
      add_light_key(root, row, light_kinds);
    } else if (!is_of_study_tables(row.path)) {
      row.path = schema_path(row.path);
      add_key(root, row);
    }
  }
  add_lighting(root, light_kinds);
  add_study_tables(root);
  for (const KeyGroup& group : key_groups()) {
    root["properties"].at(std::string(group.name))["description"] = group.doc;
  }
  return root;
}

}  // namespace glint
