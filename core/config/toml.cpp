// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/toml.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <vector>

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

/// The path that tells files apart; a pipe has none but its own.
fs::path identity_of(const fs::path& path) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(path, error);
  return error ? fs::absolute(path).lexically_normal() : canonical;
}

/// What a device or a pipe holds, up to one byte more than is allowed.
std::string read_stream(const fs::path& path, std::size_t max_bytes) {
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw IoError(fmt::format("{}: cannot be read: {}", path.string(), last_system_error()));
  }
  std::string bytes(max_bytes + 1, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

/// Reads a file and what it includes.
class TomlLoader {
 public:
  /// @param asked_by  place of the include that names the file, for messages; else empty
  ConfigNode load(const fs::path& path, const std::string& asked_by = "") {
    enter(path, asked_by);
    ConfigNode root = parse_toml(read(path, asked_by), path.string());
    ConfigNode merged = ConfigNode::table();
    if (const ConfigNode* includes = root.find("include")) {
      merge_includes(*includes, merged);
    }
    open_.pop_back();
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

 private:
  struct OpenFile {
    fs::path identity;
    std::string name;
  };

  void enter(const fs::path& path, const std::string& asked_by) {
    const OpenFile file = {.identity = identity_of(path), .name = path.string()};
    const auto first = std::ranges::find(open_, file.identity, &OpenFile::identity);
    if (first == open_.end()) {
      open_.push_back(file);
      return;
    }
    std::string chain;
    for (auto at = first; at != open_.end(); ++at) {
      chain += at->name + " -> ";
    }
    throw ConfigError(
        fmt::format("{}the file includes itself: {}{}", asked_by, chain, first->name));
  }

  static std::string read(const fs::path& path, const std::string& asked_by) {
    constexpr std::size_t kMaxBytes = std::size_t{kMaxTomlMegabytes} << 20U;
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    std::string bytes;
    bool is_large = fs::is_regular_file(status) && fs::file_size(path, ignored) > kMaxBytes;
    if (!is_large) {
      try {
        bytes = fs::is_other(status) ? read_stream(path, kMaxBytes) : read_file(path);
      } catch (const IoError& error) {
        throw IoError(asked_by + error.what());
      }
      is_large = bytes.size() > kMaxBytes;
    }
    if (is_large) {
      throw ConfigError(
          fmt::format("{}{}: is no study file: it holds more than {} MB, which is the most allowed",
                      asked_by,
                      path.string(),
                      kMaxTomlMegabytes));
    }
    return bytes;
  }

  void merge_includes(const ConfigNode& includes, ConfigNode& merged) {
    if (!includes.is_array()) {
      throw ConfigError(includes.place.prefix() +
                        "include: must be an array of file names, like [\"base.toml\"]");
    }
    for (const ConfigNode& include : includes.items) {
      if (include.kind != ConfigNode::Kind::kText) {
        throw ConfigError(include.place.prefix() + "include: must hold file names");
      }
      merge(merged, load(resolve_path(include), include.place.prefix() + "include: "));
    }
  }

  std::vector<OpenFile> open_;  ///< each included by the one before it
};

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
  return TomlLoader().load(path);
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
