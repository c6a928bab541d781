// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "core/text.h"
#include "metrics/scores.h"
#include "studies/definition/key_table.h"
#include "studies/definition/scene.h"
#include "studies/definition/study_schema.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// "lighting.my_light.x" and "defects.my_dents.x" are explained by the tables they are made of.
std::string table_name(const std::string& key) {
  std::vector<std::string> parts = split(key, '.');
  if (parts.size() >= 2 && parts[0] == "lighting" && !default_light(parts[1])) {
    parts[1] = "tunnel";
  }
  if (parts.size() >= 2 && parts[0] == "defects") {
    parts[1] = "dent";
  }
  // An array's element is explained by the array.
  while (parts.size() > 2 && parts.back().find_first_not_of("0123456789") == std::string::npos) {
    parts.pop_back();
  }
  return join(parts, ".");
}

Json row_json(const KeyRow& row) {
  return {{"key", row.path},
          {"kind", row.kind},
          {"unit", row.unit},
          {"allowed", row.allowed},
          {"default", row.default_text},
          {"doc", row.doc}};
}

std::string row_text(const KeyRow& row) {
  return fmt::format("{}\n  {}\n  {}{}{}, allowed: {}, default: {}\n",
                     row.path,
                     row.doc,
                     row.kind,
                     row.unit.empty() ? "" : " in ",
                     row.unit,
                     row.allowed,
                     row.default_text);
}

/// What is found: keys and scores.
struct Found {
  Json rows = Json::array();
  std::string text;

  void add(const KeyRow& row) {
    rows.push_back(row_json(row));
    text += row_text(row);
  }

  void add(const std::string& score, std::string_view doc) {
    rows.push_back({{"score", score}, {"doc", std::string(doc)}});
    text += fmt::format("{}\n  {}\n  a score\n", score, doc);
  }
};

bool is_below(const std::string& path, const std::string& table) {
  return path == table || path.starts_with(table + ".");
}

/// The key or table, or the score, of exactly that name.
Found find_exact(const std::string& key) {
  Found found;
  const auto score = explain_score(key);
  if (score) {
    found.add(key, *score);
  }
  const std::string wanted = table_name(key);
  for (const KeyRow& row : all_keys()) {
    if (score ? row.path == key : is_below(row.path, wanted)) {
      found.add(row);
    }
  }
  for (const ScoreDoc& doc : score_docs()) {
    if (doc.name.starts_with(key + ".")) {
      found.add(std::string(doc.name), doc.doc);
    }
  }
  return found;
}

/// The tables of a kind of light ("ring") or defect ("scratch"), or that stand within another one
/// ("paths").
Found find_table(const std::string& name) {
  Found found;
  const DefectType type = type_from_name(name);
  if (type_name(type) == name) {
    for (const KeyRow& row : keys_of(type)) {
      found.add(row);
    }
  }
  for (const KeyRow& row : all_keys()) {
    const std::size_t at = row.path.find("." + name + ".");
    if (at != std::string::npos && !row.path.starts_with("defects.")) {
      found.add(row);
    }
  }
  return found;
}

/// Everything whose name contains the text.
Found find_part(const std::string& part) {
  Found found;
  for (const KeyRow& row : all_keys()) {
    if (row.path.find(part) != std::string::npos) {
      found.add(row);
    }
  }
  for (const ScoreDoc& doc : score_docs()) {
    if (doc.name.find(part) != std::string_view::npos) {
      found.add(std::string(doc.name), doc.doc);
    }
  }
  return found;
}

Found find(const std::string& key) {
  for (const auto& look_for : {find_exact, find_table, find_part}) {
    if (Found found = look_for(key); !found.rows.empty()) {
      return found;
    }
  }
  return {};
}

/// The known name whose last parts, as many as the key has, are nearest to the key.
std::string nearest_name(const std::string& key) {
  std::vector<std::string> names;
  for (const KeyRow& row : all_keys()) {
    names.push_back(row.path);
  }
  for (const ScoreDoc& doc : score_docs()) {
    names.emplace_back(doc.name);
  }
  const std::size_t num_parts = split(key, '.').size();
  std::vector<std::string> tails;
  for (const std::string& name : names) {
    std::vector<std::string> parts = split(name, '.');
    parts.erase(parts.begin(),
                parts.end() - static_cast<std::ptrdiff_t>(std::min(num_parts, parts.size())));
    tails.push_back(join(parts, "."));
  }
  const auto at = std::ranges::find(tails, nearest(key, tails)) - tails.begin();
  return names[static_cast<std::size_t>(at)];
}

/// How many keys stand in each table below one, and how many scores: "lighting" has more than a
/// screen can show.
std::string tables_text(const std::string& table) {
  std::vector<std::pair<std::string, int>> tables;
  for (const KeyRow& row : all_keys()) {
    if (is_below(row.path, table)) {
      const std::string name = row.path.substr(0, row.path.find('.', table.size() + 1));
      const auto found = std::ranges::find(tables, name, &std::pair<std::string, int>::first);
      ++(found == tables.end() ? tables.emplace_back(name, 0) : *found).second;
    }
  }
  std::string text;
  for (const auto& [name, count] : tables) {
    text += fmt::format("  {:<28} {} keys\n", name, count);
  }
  return text;
}

/// Of more keys than this only their tables are listed, where they stand in several.
constexpr std::size_t kMaxShown = 100;

std::string text_of(const std::string& key, const Found& found) {
  if (found.rows.size() <= kMaxShown || key.find('.') != std::string::npos) {
    return found.text;
  }
  const std::string tables = tables_text(key);
  return std::ranges::count(tables, '\n') < 2
             ? found.text
             : fmt::format("{}\nglint explain TABLE shows the keys of one\n", tables);
}

int num_keys(std::string_view group) {
  return static_cast<int>(std::ranges::count_if(all_keys(), [&](const KeyRow& row) {
    return row.path.substr(0, row.path.find('.')) == group;
  }));
}

/// The tables of a study file and the families of scores, a line each.
int list_groups(const CommonArguments& common) {
  Json groups = Json::array();
  std::string text = "Tables of a study file, and how many keys they have:\n";
  for (const KeyGroup& group : key_groups()) {
    const int count = num_keys(group.name);
    groups.push_back(
        {{"name", std::string(group.name)}, {"doc", std::string(group.doc)}, {"keys", count}});
    text += fmt::format("  {:<12} {:>4}  {}\n", group.name, count, group.doc);
  }
  std::vector<std::string> families;
  for (const ScoreDoc& doc : score_docs()) {
    const std::string family(doc.name.substr(0, doc.name.find('.')));
    if (families.empty() || families.back() != family) {
      families.push_back(family);
    }
  }
  text += fmt::format("Families of scores: {}\n\n", join(families, ", "));
  text +=
      "glint explain NAME shows the keys of a table, a kind of light or defect (ring, scratch),\n"
      "scores, or whatever has the text in its name; glint explain --all shows everything\n";
  print_result(
      common, {{"schema", 1}, {"status", "done"}, {"groups", groups}, {"scores", families}}, text);
  return kExitDone;
}

}  // namespace

int explain_command(const ExplainArguments& arguments, const CommonArguments& common) {
  if (arguments.is_schema) {
    const Json schema = study_schema();
    print_result(common, schema, schema.dump(2) + "\n");
    return kExitDone;
  }
  if (arguments.key.empty() && !arguments.is_all) {
    return list_groups(common);
  }
  const std::string& key = arguments.key;
  const Found found = arguments.is_all ? find_part("") : find(key);
  if (found.rows.empty()) {
    throw ConfigError(
        fmt::format("{}: no such key or score, the nearest is {}", key, nearest_name(key)));
  }
  print_result(common,
               {{"schema", 1}, {"status", "done"}, {"found", found.rows}},
               arguments.is_all ? found.text : text_of(key, found));
  return kExitDone;
}

}  // namespace glint
