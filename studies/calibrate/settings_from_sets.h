// SPDX-License-Identifier: GPL-3.0-or-later
//
// Settings of a table that no file holds: `--set table.key=value` alone gives them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/config/keys.h"
#include "core/config/toml.h"
#include "studies/definition/study.h"

namespace glint {

inline bool is_of_table(const KeyValue& set, const std::string& table) {
  return set.path.starts_with(table + ".");
}

/// What the command line gives a table, defaults for the rest; sets of other tables are passed
/// over.
/// @throws ConfigError with all problems
template <class Settings>
Settings settings_from_sets(const std::vector<KeyValue>& sets, const std::string& table) {
  ConfigNode root = ConfigNode::table();
  for (const KeyValue& set : sets) {
    if (is_of_table(set, table)) {
      ConfigNode value = parse_override(set.value);
      value.place = {.file = "--set"};
      set_path(root, set.path, std::move(value));
    }
  }
  Settings settings;
  std::vector<Problem> errors;
  KeyReader reader(root.find(table), table, errors);
  visit_keys(reader, settings);
  reader.report_unknown();
  throw_if_any(errors);
  return settings;
}

}  // namespace glint
