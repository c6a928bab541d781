// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/overrides.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/keys.h"
#include "core/config/toml.h"
#include "core/text.h"
#include "studies/definition/scene.h"

namespace glint {
namespace {

/// Copies what a path runs through from the resolved scene when the file leaves it to its default:
/// an array element cannot be set in an array that is not there.
void make_way(ConfigNode& root, const ConfigNode& resolved, const std::string& path) {
  std::string prefix;
  for (const std::string& part : split(path, '.')) {
    prefix += (prefix.empty() ? "" : ".") + part;
    const ConfigNode* known = resolved.at_path(prefix);
    if (known == nullptr) {
      return;
    }
    if (known->is_array() && root.at_path(prefix) == nullptr) {
      set_path(root, prefix, *known);
      return;
    }
  }
}

/// The parts of a dotted path; a part in quotes may hold dots:
/// variables."lighting.tunnel.radius_mm".min
std::vector<std::string> quoted_parts(const std::string& path) {
  std::vector<std::string> parts(1);
  bool is_quoted = false;
  for (const char c : path) {
    if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == '.' && !is_quoted) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (is_quoted || std::ranges::any_of(parts, &std::string::empty)) {
    throw ConfigError(fmt::format("--set: {} is no key path", path));
  }
  return parts;
}

}  // namespace

void put_override(ConfigNode& root,
                  const ConfigNode& resolved,
                  const std::string& path,
                  const ConfigNode& value) {
  make_way(root, resolved, path);
  set_path(root, path, value);
}

void put_set(ConfigNode& root, const std::string& path, const std::string& text) {
  ConfigNode value = parse_override(text);
  value.place = {.file = "--set"};
  if (path.find('"') == std::string::npos) {
    // An element of an array that the file leaves to its default needs the array first. What is
    // wrong with the file is said when the whole of it is read.
    std::vector<Problem> ignored;
    put_override(root, write_scene(read_scene(root, ignored)), path, value);
    return;
  }
  ConfigNode* node = &root;
  for (const std::string& part : quoted_parts(path)) {
    if (!node->is_table()) {
      throw ConfigError(fmt::format("--set: {}: \"{}\" belongs to no table", path, part));
    }
    if (node->find(part) == nullptr) {
      node->names.push_back(part);
      node->items.push_back(ConfigNode::table());
      node->items.back().place = value.place;
    }
    node = node->find(part);
  }
  *node = std::move(value);
}

void throw_if_any_of_scene(const ConfigNode& root, std::vector<Problem> problems) {
  const ConfigNode* variables = root.find("variables");
  const bool is_read = problems.empty() || variables == nullptr || !variables->is_table();
  const std::size_t count = is_read ? 0 : variables->names.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::string& path = variables->names[i];
    const std::vector<std::string> parts = split(path, '.');
    const bool is_of_group = parts.size() > 2 && (parts[0] == "lighting" || parts[0] == "defects");
    const ConfigNode* groups = is_of_group ? root.find(parts[0]) : nullptr;
    if (groups != nullptr && groups->is_table() && groups->find(parts[1]) == nullptr) {
      problems.push_back(
          {.kind = Problem::Kind::kUnknownKey,
           .place = variables->items[i].place,
           .context = "variables",
           .key = path,
           .text = fmt::format("the scene has no table [{}.{}]", parts[0], parts[1])});
    }
  }
  throw_if_any(problems);
}

}  // namespace glint
