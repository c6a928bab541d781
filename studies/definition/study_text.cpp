// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/study_text.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/text.h"
#include "studies/definition/overrides.h"
#include "studies/definition/study_tables.h"

namespace glint {
namespace {

/// Whether the part is moved or turned in some design.
bool may_be_posed(const Study& study) {
  const auto is_pose = [](std::string_view path) {
    return path == "part" || path.starts_with("part.position_mm") ||
           path.starts_with("part.rotation_deg");
  };
  return is_posed(study.scene) ||
         std::ranges::any_of(study.space.variables, is_pose, &Variable::name) ||
         std::ranges::any_of(study.prototypes, [&](const Prototype& prototype) {
           return std::ranges::any_of(prototype.overrides, is_pose, &Overrides::value_type::first);
         });
}

/// Lights in the scene were "part" before lights could follow a part's pose: hashes keep that name,
/// so that runs begun then go on. A light that does follow one gets a name no run had then.
void name_mounts_for_hash(Study& study) {
  ConfigNode* lighting = study.resolved.find("lighting");
  for (std::size_t i = 0; lighting != nullptr && i < lighting->items.size(); ++i) {
    ConfigNode* mount = lighting->items[i].find("mount");
    if (mount != nullptr && mount->text == "scene") {
      mount->text = "part";
    } else if (mount != nullptr && mount->text == "part" && may_be_posed(study)) {
      mount->text = "posed part";
    }
  }
}

/// Keys at their default that earlier programs did not write: hashes are without them, so that runs
/// begun then go on.
void drop_younger_defaults(Study& study) {
  const auto drop = [](ConfigNode* table, const std::string& key, const ConfigNode& plain) {
    for (std::size_t i = 0; table != nullptr && i < table->names.size(); ++i) {
      if (table->names[i] == key && value_to_toml(table->items[i]) == value_to_toml(plain)) {
        table->names.erase(table->names.begin() + static_cast<std::ptrdiff_t>(i));
        table->items.erase(table->items.begin() + static_cast<std::ptrdiff_t>(i));
        return;
      }
    }
  };
  drop(&study.resolved, "lighting_use", ConfigNode::from_text("all"));
  drop(study.resolved.find("sensor"), "expose_to", ConfigNode::from_number(0.0));
}

ConfigNode whole_tree(const Study& study) {
  ConfigNode root = ConfigNode::table();
  root.names.emplace_back("schema");
  root.items.push_back(ConfigNode::from_integer(needs_schema_2(study.scene) ? 2 : 1));
  root.names.emplace_back("title");
  root.items.push_back(ConfigNode::from_text(study.title));
  merge(root, study.resolved);
  for (const char* table :
       {"variables", "prototypes", "objective", "choice", "constraints", "manufacture"}) {
    if (const ConfigNode* node = study.root.find(table)) {
      root.names.emplace_back(table);
      root.items.push_back(*node);
    }
  }
  write_study_tables(study, root);
  return root;
}

/// Calls a function with each text of a tree that is a file's full path.
template <class Node, class Function>
void for_each_path(Node&& node, const Function& function) {
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    if (!node.is_table() || node.names[i] != "title") {
      for_each_path(node.items[i], function);
    }
  }
  if (node.kind == ConfigNode::Kind::kText && std::filesystem::path(node.text).is_absolute()) {
    function(node);
  }
}

/// A plain value, or an array of them, with its path.
using PlacedValue = std::pair<std::string, std::string>;

bool has_table(const ConfigNode& node) {
  return node.is_table() || (node.is_array() && std::ranges::any_of(node.items, has_table));
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
  if (!has_table(node)) {
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

/// Whether something that is kept depends on the prototypes: the rung that a search is rendered by,
/// and parts that were inspected under them.
bool keeps_of_prototypes(const Study& study) {
  return study.accuracy || study.sorting || study.pod;
}

bool changes_no_result(const Study& study, const std::string& path) {
  return path == "title" || path.starts_with("budget.") ||
         (path.starts_with("prototypes.") && !keeps_of_prototypes(study));
}

void erase_key(ConfigNode& table, const std::string& key) {
  const auto found = std::ranges::find(table.names, key);
  if (found != table.names.end()) {
    table.items.erase(table.items.begin() + (found - table.names.begin()));
    table.names.erase(found);
  }
}

/// With the prototypes of a recorded one, as far as a hash takes note of them.
Study with_prototypes_of(Study study, const ConfigNode& recorded) {
  erase_key(study.root, "prototypes");
  study.prototypes.clear();
  if (const ConfigNode* prototypes = recorded.find("prototypes")) {
    study.root.names.emplace_back("prototypes");
    study.root.items.push_back(*prototypes);
    for (const ConfigNode& table : prototypes->items) {
      Prototype prototype;
      for (std::size_t i = 0; i < table.names.size(); ++i) {
        prototype.overrides.emplace_back(table.names[i], table.items[i]);
      }
      study.prototypes.push_back(std::move(prototype));
    }
  }
  return study;
}

/// Of all but the budget.
std::string hash_of(Study hashed) {
  hashed.budget = {};
  name_mounts_for_hash(hashed);
  drop_younger_defaults(hashed);
  std::string text = resolved_text(hashed);
  for (const std::filesystem::path& file : input_files(hashed.scene)) {
    text += read_file(file);
  }
  return sha256_hex(text);
}

}  // namespace

std::string resolved_text(const Study& study) {
  return to_toml(whole_tree(study));
}

std::string shown_text(const Study& study) {
  ConfigNode root = whole_tree(study);
  for_each_path(root, [](ConfigNode& node) {
    node.text = std::filesystem::path(node.text).filename().string();
  });
  return to_toml(root);
}

std::string without_folders(std::string text, const Study& study) {
  for_each_path(whole_tree(study), [&](const ConfigNode& node) {
    const std::string folder = (std::filesystem::path(node.text).parent_path() / "").string();
    for (auto at = text.find(folder); folder != "/" && at != std::string::npos;
         at = text.find(folder, at)) {
      text.erase(at, folder.size());
    }
  });
  return text;
}

std::string config_hash(const Study& study) {
  Study hashed = study;
  if (!keeps_of_prototypes(study)) {
    erase_key(hashed.root, "prototypes");
    hashed.prototypes.clear();
  }
  return hash_of(std::move(hashed));
}

bool is_recorded_as(const Study& study, const std::string& hash, const std::string& recorded) {
  if (config_hash(study) == hash) {
    return true;
  }
  const Study titled = with_title_of(study, recorded);
  if (config_hash(titled) == hash) {
    return true;
  }
  // Earlier programs counted prototypes.
  return !keeps_of_prototypes(study) &&
         hash_of(with_prototypes_of(titled, parse_toml(recorded, "study.resolved.toml"))) == hash;
}

Study with_title_of(Study study, const std::string& recorded) {
  const ConfigNode root = parse_toml(recorded, "study.resolved.toml");
  const ConfigNode* title = root.find("title");
  study.title = title != nullptr ? title->text : "";
  return study;
}

std::vector<ChangedKey> changed_keys(const Study& study, const std::string& recorded) {
  const std::vector<PlacedValue> now = values_of(resolved_text(study));
  std::vector<PlacedValue> before = values_of(recorded);
  std::vector<ChangedKey> changes;
  for (const auto& [path, value] : now) {
    const auto found = std::ranges::find(before, path, &PlacedValue::first);
    const bool was_there = found != before.end();
    if (!changes_no_result(study, path) && (!was_there || found->second != value)) {
      changes.push_back({.path = path, .is = value, .was = {}});
      if (was_there) {
        changes.back().was = found->second;
      }
    }
    if (was_there) {
      before.erase(found);
    }
  }
  for (const auto& [path, value] : before) {
    if (!changes_no_result(study, path)) {
      changes.push_back({.path = path, .is = {}, .was = value});
    }
  }
  return changes;
}

std::vector<std::string> change_texts(std::span<const ChangedKey> changes) {
  std::vector<std::string> texts;
  for (const auto& [path, is, was] : changes) {
    texts.push_back(!is    ? fmt::format("{} was {}, is gone", path, was.value_or(""))
                    : !was ? fmt::format("{} is {}, was not there", path, *is)
                           : fmt::format("{} is {}, was {}", path, *is, *was));
  }
  return texts;
}

}  // namespace glint
