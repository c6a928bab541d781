// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/comparison/run_comparison.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 12> kOfScale = {"part",
                                                       "material",
                                                       "camera",
                                                       "lens",
                                                       "viewpoint",
                                                       "viewpoints",
                                                       "sensor",
                                                       "scan",
                                                       "defects",
                                                       "imprint",
                                                       "inspection",
                                                       "metrics"};

/// Scores of one family, by the beginning of their names, and the table that they are measured by
/// beside those.
struct FamilyTable {
  std::string_view beginning;
  std::string_view table;
};

constexpr std::array<FamilyTable, 6> kOfFamily = {{{"cost.", "cost"},
                                                   {"scan.time_s", "cost"},
                                                   {"coverage.", "coverage"},
                                                   {"overlap.", "reference"},
                                                   {"appearance.", "reference"},
                                                   {"reach.", "cell"}}};

/// What of these tables is set to suit a lighting.
constexpr std::array<std::string_view, 3> kOfExposure = {
    "sensor.exposure", "sensor.gain", "sensor.expose_to"};

/// What a run may have of its own and yet be compared without a word.
constexpr std::array<std::string_view, 1> kOfDesign = {"lighting"};

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// What a file holds; its name where it cannot be read any more.
std::string content_of(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored) ? sha256_hex(read_file(file))
                                                         : file.filename().string();
}

/// The keys of the files that count by their content, wherever they lie.
std::vector<std::pair<std::string, std::filesystem::path>> files_of(const SceneSettings& scene) {
  return {{"part.file", scene.part.file},
          {"material.nk_file", scene.material.nk_file},
          {"material.texture.colour_file", scene.material.texture.colour_file},
          {"material.texture.roughness_file", scene.material.texture.roughness_file}};
}

/// The value of a table that comparisons look at, as text.
std::string text_of_table(const Study& study, const std::string& table) {
  const ConfigNode* node = study.resolved.find(table);
  if (node == nullptr) {
    return "";
  }
  ConfigNode root = ConfigNode::table();
  root.names = {table};
  root.items = {*node};
  for (const auto& [key, file] : files_of(study.scene)) {
    if (key.starts_with(table + ".") && !file.empty()) {
      set_path(root, key, ConfigNode::from_text(content_of(file)));
    }
  }
  return to_toml(root);
}

/// Whether a key describes the design that a study looks for, not what it is judged by.
bool is_of_design(const std::string& key) {
  constexpr std::array<std::string_view, 3> kOfTask = {"defects.", "imprint.", "metrics."};
  return std::ranges::none_of(kOfTask,
                              [&](std::string_view table) { return key.starts_with(table); });
}

/// The study without what tells its designs from one another: its variables, those of another one
/// and how the picture is exposed.
Study without_designs(Study study, const Study& other) {
  std::vector<std::string> keys(kOfExposure.begin(), kOfExposure.end());
  for (const SearchSpace& space : {study.space, other.space}) {
    for (const Variable& variable : space.variables) {
      keys.push_back(variable.name);
    }
  }
  for (const std::string& key : keys) {
    if (is_of_design(key) && study.resolved.at_path(key) != nullptr) {
      set_path(study.resolved, key, ConfigNode::from_text("of the design"));
    }
  }
  return study;
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

/// The tables that tell on what scale a study's objectives are.
std::vector<std::string> tables_of_scale(const Study& study) {
  std::vector<std::string> tables(kOfScale.begin(), kOfScale.end());
  for (const Objective& objective : objectives_of(study.goal)) {
    for (const FamilyTable& family : kOfFamily) {
      if (objective.name.starts_with(family.beginning)) {
        tables.emplace_back(family.table);
      }
    }
  }
  return tables;
}

}  // namespace

bool is_comparable(const Study& a, const Study& b) {
  const Study one = without_designs(a, b);
  const Study other = without_designs(b, a);
  return objective_of(a) == objective_of(b) &&
         std::ranges::all_of(tables_of_scale(a), [&](const std::string& table) {
           return text_of_table(one, table) == text_of_table(other, table);
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
