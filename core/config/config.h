// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace glint {

/// One value of a study file with the place it was written: a plain tree that outlives the parser.
struct ConfigNode {
  enum class Kind { kBoolean, kInteger, kNumber, kText, kArray, kTable };

  Kind kind = Kind::kTable;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0.0;  ///< also set for integers
  std::string text;
  std::vector<std::string> names;  ///< of a table's items, in file order
  std::vector<ConfigNode> items;   ///< of an array or a table
  Place place;

  bool is_table() const { return kind == Kind::kTable; }

  bool is_array() const { return kind == Kind::kArray; }

  bool is_number() const { return kind == Kind::kInteger || kind == Kind::kNumber; }

  /// The item of that name; nullptr when there is none or this is no table.
  const ConfigNode* find(std::string_view name) const;
  ConfigNode* find(std::string_view name);

  /// The value at a dotted path; numeric parts index arrays ("viewpoint.0.position_mm.2").
  const ConfigNode* at_path(std::string_view path) const;

  static ConfigNode from_boolean(bool value);
  static ConfigNode from_integer(std::int64_t value);
  static ConfigNode from_number(double value);
  static ConfigNode from_text(std::string value);
  static ConfigNode array();
  static ConfigNode table();
};

/// Puts a value at a dotted path, making tables on the way.
/// @throws ConfigError when the path runs through a plain value or beyond an array's end.
void set_path(ConfigNode& root, std::string_view path, ConfigNode value);

/// Lays one table over another: tables merge, everything else is replaced.
void merge(ConfigNode& base, const ConfigNode& over);

/// The tree as TOML text; parsing it gives the same tree.
std::string to_toml(const ConfigNode& root);

/// A value as it would stand in TOML, on one line.
std::string value_to_toml(const ConfigNode& value);

/// A file named by a configuration value: relative to the TOML file it stands in, or to the current
/// folder when it came from the command line.
std::filesystem::path resolve_path(const ConfigNode& value);

}  // namespace glint
