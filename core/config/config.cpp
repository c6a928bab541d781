// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

std::optional<std::size_t> array_index(std::string_view part) {
  std::size_t index = 0;
  const auto result = std::from_chars(part.data(), part.data() + part.size(), index);
  if (result.ec != std::errc() || result.ptr != part.data() + part.size()) {
    return std::nullopt;
  }
  return index;
}

bool is_bare_key(std::string_view key) {
  return !key.empty() && std::ranges::all_of(key, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

std::string quoted_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (c == '\t') {
      result += "\\t";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string key_text(std::string_view key) {
  return is_bare_key(key) ? std::string(key) : quoted_text(key);
}

std::string number_text(double value) {
  const std::string text = shortest(value);
  const bool is_plain_integer = text.find_first_of(".eni") == std::string::npos;
  return is_plain_integer ? text + ".0" : text;
}

bool is_array_of_tables(const ConfigNode& node) {
  return node.is_array() && !node.items.empty() &&
         std::ranges::all_of(node.items, &ConfigNode::is_table);
}

void write_table(const ConfigNode& table, const std::string& path, std::string& out) {
  for (std::size_t i = 0; i < table.items.size(); ++i) {
    if (!table.items[i].is_table() && !is_array_of_tables(table.items[i])) {
      out += fmt::format("{} = {}\n", key_text(table.names[i]), value_to_toml(table.items[i]));
    }
  }
  for (std::size_t i = 0; i < table.items.size(); ++i) {
    const ConfigNode& item = table.items[i];
    const std::string item_path = (path.empty() ? "" : path + ".") + key_text(table.names[i]);
    if (item.is_table()) {
      out += fmt::format("\n[{}]\n", item_path);
      write_table(item, item_path, out);
    } else if (is_array_of_tables(item)) {
      for (const ConfigNode& element : item.items) {
        out += fmt::format("\n[[{}]]\n", item_path);
        write_table(element, item_path, out);
      }
    }
  }
}

/// @param path  what the part belongs to, for what is said of it
ConfigNode& item_at(ConfigNode& array,
                    const std::string& part,
                    std::string_view path,
                    const Place& place) {
  const auto index = array_index(part);
  if (!index || *index >= array.items.size()) {
    throw ConfigError(
        Problem{.kind = Problem::Kind::kUnknownKey,
                .place = place,
                .key = std::string(path),
                .text = fmt::format("the array has {} items, so the index must be below {}",
                                    array.items.size(),
                                    array.items.size())});
  }
  return array.items[*index];
}

/// The value of a key, which is added as a table where there is none.
ConfigNode& value_at(ConfigNode& table, const std::string& key, const Place& place) {
  if (ConfigNode* value = table.find(key)) {
    return *value;
  }
  table.names.push_back(key);
  table.items.push_back(ConfigNode::table());
  table.items.back().place = place;
  return table.items.back();
}

}  // namespace

const ConfigNode* ConfigNode::find(std::string_view name) const {
  const auto position = std::ranges::find(names, name);
  return position == names.end() ? nullptr
                                 : &items[static_cast<std::size_t>(position - names.begin())];
}

ConfigNode* ConfigNode::find(std::string_view name) {
  return const_cast<ConfigNode*>(std::as_const(*this).find(name));
}

const ConfigNode* ConfigNode::at_path(std::string_view path) const {
  const ConfigNode* node = this;
  for (const std::string& part : split(path, '.')) {
    const auto index = node->is_array() ? array_index(part) : std::nullopt;
    if (node->is_array()) {
      node = index && *index < node->items.size() ? &node->items[*index] : nullptr;
    } else {
      node = node->find(part);
    }
    if (node == nullptr) {
      return nullptr;
    }
  }
  return node;
}

ConfigNode ConfigNode::from_boolean(bool value) {
  ConfigNode node;
  node.kind = Kind::kBoolean;
  node.boolean = value;
  return node;
}

ConfigNode ConfigNode::from_integer(std::int64_t value) {
  ConfigNode node;
  node.kind = Kind::kInteger;
  node.integer = value;
  node.number = static_cast<double>(value);
  return node;
}

ConfigNode ConfigNode::from_number(double value) {
  ConfigNode node;
  node.kind = Kind::kNumber;
  node.number = value;
  return node;
}

ConfigNode ConfigNode::from_text(std::string value) {
  ConfigNode node;
  node.kind = Kind::kText;
  node.text = std::move(value);
  return node;
}

ConfigNode ConfigNode::array() {
  ConfigNode node;
  node.kind = Kind::kArray;
  return node;
}

ConfigNode ConfigNode::table() {
  return {};
}

void set_path(ConfigNode& root, std::string_view path, ConfigNode value) {
  ConfigNode* node = &root;
  const std::vector<std::string> parts = split(path, '.');
  const Place place = value.place;
  if (std::ranges::any_of(parts, &std::string::empty)) {
    throw ConfigError(Problem{.place = place, .text = fmt::format("\"{}\" is no key path", path)});
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool is_last = i + 1 == parts.size();
    ConfigNode* next = nullptr;
    if (node->is_array()) {
      next = &item_at(*node, parts[i], path, place);
    } else if (node->is_table()) {
      next = &value_at(*node, parts[i], place);
    } else {
      throw ConfigError(Problem{.kind = Problem::Kind::kUnknownKey,
                                .place = place,
                                .key = std::string(path),
                                .text = fmt::format("\"{}\" is a plain value and has no keys",
                                                    i == 0 ? "" : parts[i - 1])});
    }
    if (is_last) {
      *next = std::move(value);
      return;
    }
    node = next;
  }
}

void merge(ConfigNode& base, const ConfigNode& over) {
  if (!base.is_table() || !over.is_table()) {
    base = over;
    return;
  }
  for (std::size_t i = 0; i < over.names.size(); ++i) {
    if (ConfigNode* existing = base.find(over.names[i])) {
      merge(*existing, over.items[i]);
    } else {
      base.names.push_back(over.names[i]);
      base.items.push_back(over.items[i]);
    }
  }
}

std::string value_to_toml(const ConfigNode& value) {
  switch (value.kind) {
    case ConfigNode::Kind::kBoolean:
      return value.boolean ? "true" : "false";
    case ConfigNode::Kind::kInteger:
      return fmt::format("{}", value.integer);
    case ConfigNode::Kind::kNumber:
      return number_text(value.number);
    case ConfigNode::Kind::kText:
      return quoted_text(value.text);
    case ConfigNode::Kind::kArray: {
      std::vector<std::string> parts;
      std::ranges::transform(value.items, std::back_inserter(parts), value_to_toml);
      return fmt::format("[{}]", join(parts, ", "));
    }
    case ConfigNode::Kind::kTable: {
      std::vector<std::string> parts;
      for (std::size_t i = 0; i < value.items.size(); ++i) {
        parts.push_back(key_text(value.names[i]) + " = " + value_to_toml(value.items[i]));
      }
      return parts.empty() ? "{}" : fmt::format("{{ {} }}", join(parts, ", "));
    }
  }
  return "";
}

std::string to_toml(const ConfigNode& root) {
  std::string out;
  write_table(root, "", out);
  return out.starts_with('\n') ? out.substr(1) : out;
}

fs::path resolve_path(const ConfigNode& value) {
  fs::path path = value.text;
  if (path.is_absolute() || value.place.file.empty() || value.place.line == 0) {
    return path;
  }
  std::error_code ignored;
  const fs::path file = value.place.file;
  const bool is_stream = fs::is_other(fs::status(file, ignored));
  return is_stream ? path : file.parent_path() / path;
}

}  // namespace glint
