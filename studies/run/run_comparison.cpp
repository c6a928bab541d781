// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run_comparison.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 7> kOfScale = {
    "part", "camera", "lens", "viewpoint", "viewpoints", "defects", "imprint"};

/// What a run may have of its own and yet be compared without a word.
constexpr std::array<std::string_view, 1> kOfDesign = {"lighting"};

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// What a part's file holds; its name where it cannot be read any more.
std::string content_of(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored) ? sha256_hex(read_file(file))
                                                         : file.filename().string();
}

/// The value of a table that comparisons look at, as text.
std::string text_of_table(const Study& study, const std::string& table) {
  const ConfigNode* node = study.resolved.find(table);
  if (node == nullptr) {
    return "";
  }
  ConfigNode copy = *node;
  if (table == "part" && !study.scene.part.file.empty()) {
    set_path(copy, "file", ConfigNode::from_text(content_of(study.scene.part.file)));
  }
  return copy.is_table() ? to_toml(copy) : value_to_toml(copy);
}

std::string objective_of(const Study& study) {
  std::vector<std::string> names;
  for (const Objective& objective : objectives_of(study.goal)) {
    names.push_back(fmt::format("{} {}", objective.is_maximised ? "max" : "min", objective.name));
  }
  return study.has_objective ? join(names, ", ") : "";
}

std::string constraints_of(const Study& study) {
  const ConfigNode* node = study.root.find("constraints");
  return node == nullptr ? "" : to_toml(*node);
}

/// Names of a table's own entries that are not the same in both.
std::vector<std::string> changed_keys(const ConfigNode* a, const ConfigNode* b) {
  std::vector<std::string> keys;
  if (a == nullptr || b == nullptr || !a->is_table() || !b->is_table()) {
    return keys;
  }
  const auto text = [](const ConfigNode* item) {
    return item == nullptr ? std::string() : value_to_toml(*item);
  };
  std::vector<std::string> names = a->names;
  std::ranges::copy_if(b->names, std::back_inserter(names), [&](const std::string& name) {
    return a->find(name) == nullptr;
  });
  std::ranges::copy_if(names, std::back_inserter(keys), [&](const std::string& name) {
    return text(a->find(name)) != text(b->find(name));
  });
  return keys;
}

}  // namespace

bool is_comparable(const Study& a, const Study& b) {
  return objective_of(a) == objective_of(b) &&
         std::ranges::all_of(kOfScale, [&](std::string_view table) {
           const std::string name(table);
           return text_of_table(a, name) == text_of_table(b, name);
         });
}

std::vector<std::string> differences(const Study& a, const Study& b) {
  std::vector<std::string> found;
  for (const std::string& table : scene_tables()) {
    if (is_among(kOfDesign, table) || text_of_table(a, table) == text_of_table(b, table)) {
      continue;
    }
    const std::vector<std::string> keys =
        changed_keys(a.resolved.find(table), b.resolved.find(table));
    found.push_back(keys.empty() ? table : fmt::format("{} ({})", table, join(keys, ", ")));
  }
  if (objective_of(a) != objective_of(b)) {
    found.emplace_back("objective");
  }
  if (constraints_of(a) != constraints_of(b)) {
    found.emplace_back("constraints");
  }
  return found;
}

}  // namespace glint
