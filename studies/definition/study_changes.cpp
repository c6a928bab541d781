// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/study_changes.h"
#include "studies/definition/study_text.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/config/toml.h"
#include "core/text.h"

namespace glint {
namespace {

/// A plain value, or an array of them, with its path.
using PlacedValue = std::pair<std::string, std::string>;

bool holds_tables(const ConfigNode& node) {
  return node.is_table() || (node.is_array() && std::ranges::any_of(node.items, holds_tables));
}

/// A number is the same one however it is written: 95 and 95.0.
std::string value_text(const ConfigNode& node) {
  if (!node.is_array()) {
    return node.is_number() ? shortest(node.number) : value_to_toml(node);
  }
  std::vector<std::string> items;
  for (const ConfigNode& item : node.items) {
    items.push_back(value_text(item));
  }
  return fmt::format("[{}]", join(items, ", "));
}

void collect(const ConfigNode& node, const std::string& path, std::vector<PlacedValue>& values) {
  if (!holds_tables(node)) {
    values.emplace_back(path, value_text(node));
    return;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const std::string name = node.is_table() ? node.names[i] : fmt::format("{}", i);
    collect(node.items[i], joined_path(path, name), values);
  }
}

std::vector<PlacedValue> values_of(const std::string& text) {
  std::vector<PlacedValue> values;
  collect(parse_toml(text, "study.resolved.toml"), "", values);
  return values;
}

bool changes_no_result(const std::string& path) {
  return path == "title" || path.starts_with("budget.");
}

}  // namespace

Study with_title_of(Study study, const std::string& recorded) {
  const ConfigNode root = parse_toml(recorded, "study.resolved.toml");
  const ConfigNode* title = root.find("title");
  study.title = title != nullptr ? title->text : "";
  return study;
}

std::vector<std::string> changed_keys(const Study& study, const std::string& recorded) {
  const std::vector<PlacedValue> now = values_of(resolved_text(study));
  std::vector<PlacedValue> before = values_of(recorded);
  std::vector<std::string> changes;
  for (const auto& [path, value] : now) {
    const auto found = std::ranges::find(before, path, &PlacedValue::first);
    const bool was_there = found != before.end();
    if (!changes_no_result(path) && (!was_there || found->second != value)) {
      changes.push_back(was_there ? fmt::format("{} is {}, was {}", path, value, found->second)
                                  : fmt::format("{} is {}, was not there", path, value));
    }
    if (was_there) {
      before.erase(found);
    }
  }
  for (const auto& [path, value] : before) {
    if (!changes_no_result(path)) {
      changes.push_back(fmt::format("{} was {}, is gone", path, value));
    }
  }
  return changes;
}

}  // namespace glint
