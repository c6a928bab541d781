// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/toml.h"

#include <set>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "core/file.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

Place place_of(const toml::source_region& region, const std::string& file) {
  return {.file = file,
          .line = static_cast<int>(region.begin.line),
          .column = static_cast<int>(region.begin.column)};
}

ConfigNode convert(const toml::node& node, const std::string& file);

ConfigNode convert_table(const toml::table& table, const std::string& file) {
  // toml++ sorts keys; file order is what people wrote, so it is restored from the places.
  ConfigNode result = ConfigNode::table();
  for (const auto& [key, value] : table) {
    ConfigNode item = convert(value, file);
    item.place = place_of(key.source(), file);
    const auto is_before = [](const Place& a, const Place& b) {
      return a.line != b.line ? a.line < b.line : a.column < b.column;
    };
    std::size_t position = result.items.size();
    while (position > 0 && is_before(item.place, result.items[position - 1].place)) {
      --position;
    }
    const auto offset = static_cast<std::ptrdiff_t>(position);
    result.names.insert(result.names.begin() + offset, std::string(key.str()));
    result.items.insert(result.items.begin() + offset, std::move(item));
  }
  return result;
}

ConfigNode convert(const toml::node& node, const std::string& file) {
  ConfigNode result;
  if (const auto* table = node.as_table()) {
    result = convert_table(*table, file);
  } else if (const auto* array = node.as_array()) {
    result = ConfigNode::array();
    for (const toml::node& item : *array) {
      result.items.push_back(convert(item, file));
    }
  } else if (const auto* boolean = node.as_boolean()) {
    result = ConfigNode::from_boolean(boolean->get());
  } else if (const auto* integer = node.as_integer()) {
    result = ConfigNode::from_integer(integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    result = ConfigNode::from_number(number->get());
  } else if (const auto* text = node.as_string()) {
    result = ConfigNode::from_text(text->get());
  } else {
    throw ConfigError(place_of(node.source(), file).prefix() +
                      "dates and times are not used in study files");
  }
  result.place = place_of(node.source(), file);
  return result;
}

ConfigNode load_nested(const fs::path& path, std::set<fs::path>& open_files) {
  const fs::path canonical = fs::weakly_canonical(path);
  if (!open_files.insert(canonical).second) {
    throw ConfigError(path.string() + ": include: the file includes itself");
  }
  ConfigNode root = parse_toml(read_file(path), path.string());
  ConfigNode merged = ConfigNode::table();
  if (const ConfigNode* includes = root.find("include")) {
    if (!includes->is_array()) {
      throw ConfigError(includes->place.prefix() +
                        "include: must be an array of file names, like [\"base.toml\"]");
    }
    for (const ConfigNode& include : includes->items) {
      if (include.kind != ConfigNode::Kind::kText) {
        throw ConfigError(include.place.prefix() + "include: must hold file names");
      }
      merge(merged, load_nested(resolve_path(include), open_files));
    }
  }
  open_files.erase(canonical);
  merge(merged, root);
  for (std::size_t i = 0; i < merged.names.size(); ++i) {
    if (merged.names[i] == "include") {
      merged.names.erase(merged.names.begin() + static_cast<std::ptrdiff_t>(i));
      merged.items.erase(merged.items.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    }
  }
  return merged;
}

/// Refuses keys of absurdly many parts (a.a.a...): the parser recurses once a part.
void refuse_deep_keys(std::string_view text, const std::string& file) {
  constexpr int kMaxParts = 500;
  int line = 1;
  int dots = 0;
  for (const char c : text) {
    line += c == '\n' ? 1 : 0;
    dots = c == '.' ? dots + 1 : (c == '\n' || c == ',' || c == '=') ? 0 : dots;
    if (dots >= kMaxParts) {
      throw ConfigError(Place{.file = file, .line = line}.prefix() +
                        fmt::format("a key has more than {} parts", kMaxParts));
    }
  }
}

/// Replaces the places inside a value by one that stands for the command line.
void set_place(ConfigNode& node, const Place& place) {
  node.place = place;
  for (ConfigNode& item : node.items) {
    set_place(item, place);
  }
}

}  // namespace

ConfigNode parse_toml(std::string_view text, const std::string& file) {
  refuse_deep_keys(text, file);
  try {
    return convert_table(toml::parse(text), file);
  } catch (const toml::parse_error& error) {
    throw ConfigError(place_of(error.source(), file).prefix() + std::string(error.description()));
  }
}

ConfigNode load_toml(const fs::path& path) {
  std::set<fs::path> open_files;
  return load_nested(path, open_files);
}

ConfigNode parse_override(std::string_view text) {
  ConfigNode value = ConfigNode::from_text(std::string(text));
  try {
    const ConfigNode root = parse_toml("value = " + std::string(text), "");
    if (root.items.size() == 1) {
      value = root.items.front();
    }
  } catch (const ConfigError&) {
    // No TOML value (or a date): the shell has taken the quotes of a plain text.
  }
  set_place(value, {.file = "--set"});
  return value;
}

}  // namespace glint
