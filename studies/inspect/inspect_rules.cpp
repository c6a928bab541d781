// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_rules.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include <fmt/format.h>

#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "core/csv.h"
#include "core/file.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr const char* kTable = "inspection";

/// A file's [inspection] table as it is written; nullptr when it has none.
const ConfigNode* table_of(const ConfigNode& root) {
  const ConfigNode* table = root.find(kTable);
  if (table != nullptr && !table->is_table()) {
    throw ConfigError(table->place.prefix() + "inspection: must be a table, like [inspection]");
  }
  return table;
}

bool has_limits_in(const ConfigNode& table) {
  return table.find("holes") != nullptr || table.find("scratches") != nullptr;
}

bool is_any_positive(const GradeLimits& limits) {
  return limits.acceptable_biggest > 0.0 || limits.acceptable_sum > 0.0;
}

std::string lower_case(std::string text) {
  std::ranges::transform(
      text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::optional<Grade> grade_from(const std::string& text) {
  for (const Grade grade : {Grade::kPerfect, Grade::kAcceptable, Grade::kRejected}) {
    if (lower_case(std::string(grade_name(grade))) == lower_case(text)) {
      return grade;
    }
  }
  return std::nullopt;
}

/// Puts the values of the command line over the tables.
bool put_sets(std::span<const KeyValue> sets, ConfigNode& root) {
  bool has_limits = false;
  for (const KeyValue& set : sets) {
    if (!set.path.starts_with(std::string(kTable) + ".")) {
      throw ConfigError(fmt::format(
          "--set: {}: must begin with \"inspection.\", like inspection.kernel_px=11", set.path));
    }
    ConfigNode value = parse_override(set.value);
    value.place = {.file = "--set"};
    set_path(root, set.path, std::move(value));
    has_limits = has_limits || set.path.starts_with("inspection.holes.") ||
                 set.path.starts_with("inspection.scratches.");
  }
  return has_limits;
}

}  // namespace

InspectionRules read_inspection_rules(const InspectionSettings& base,
                                      const fs::path& scene,
                                      std::span<const fs::path> files,
                                      std::span<const KeyValue> sets) {
  InspectionRules rules{.settings = base};
  ConfigNode root = ConfigNode::table();
  root.names.emplace_back(kTable);
  root.items.push_back(ConfigNode::table());
  ConfigNode& merged = root.items.front();
  if (!scene.empty()) {
    const ConfigNode whole = load_toml(scene);
    if (const ConfigNode* table = table_of(whole)) {  // scenes of older versions have none
      merge(merged, *table);
    }
  }
  for (const fs::path& file : files) {
    const ConfigNode whole = load_toml(file);
    const ConfigNode* table = table_of(whole);
    if (table == nullptr) {
      throw ConfigError(file.string() + ": holds no table [inspection]");
    }
    merge(merged, *table);
    rules.has_limits = rules.has_limits || has_limits_in(*table);
  }
  rules.has_limits = put_sets(sets, root) || rules.has_limits;
  std::vector<Problem> errors;
  KeyReader reader(root.find(kTable), kTable, errors);
  visit_keys(reader, rules.settings);
  reader.report_unknown();
  throw_if_any(errors);
  rules.has_limits = rules.has_limits || is_any_positive(rules.settings.holes) ||
                     is_any_positive(rules.settings.scratches);
  return rules;
}

std::string inspection_toml(const InspectionSettings& settings) {
  InspectionSettings copy = settings;
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, copy);
  ConfigNode root = ConfigNode::table();
  root.names.emplace_back(kTable);
  root.items.push_back(std::move(table));
  return to_toml(root);
}

std::map<std::string, Grade> read_labels(const fs::path& file) {
  std::map<std::string, Grade> labels;
  for (const CsvRow& row : parse_csv(read_file(file), file.string())) {
    const Place place = {.file = file.string(), .line = row.front().place.line};
    const std::string& part = row.front().text;
    const auto grade = row.size() == 2 ? grade_from(row.back().text) : std::nullopt;
    const bool is_head = place.line == 1 && !grade && lower_case(part) == "part";
    if (is_head) {
      continue;
    }
    if (!grade) {
      throw ConfigError(place.prefix() +
                        "must be a part's name, a comma and Perfect, Acceptable or Rejected");
    }
    if (!labels.emplace(part, *grade).second) {
      throw ConfigError(fmt::format("{}part {} has a grade already", place.prefix(), part));
    }
  }
  if (labels.empty()) {
    throw ConfigError(file.string() + ": holds no part with its grade");
  }
  return labels;
}

}  // namespace glint
