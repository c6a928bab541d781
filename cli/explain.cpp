// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "core/config/key_writer.h"
#include "core/text.h"
#include "metrics/scores.h"
#include "studies/definition/scene.h"
#include "studies/definition/study_tables.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::vector<KeyRow> all_keys() {
  std::vector<KeyRow> rows = scene_keys();
  const std::vector<KeyRow> more = study_keys();
  rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

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

/// The key or table, or the score, of exactly that name.
Found find_exact(const std::string& key) {
  const std::string wanted = table_name(key);
  Found found;
  for (const KeyRow& row : all_keys()) {
    if (row.path == wanted || row.path.starts_with(wanted + ".")) {
      found.add(row);
    }
  }
  if (const auto doc = explain_score(key)) {
    found.add(key, *doc);
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

}  // namespace

int explain_command(const std::string& key, const CommonArguments& common) {
  Found found = find_exact(key);
  if (found.rows.empty() && !key.empty()) {
    found = find_part(key);
  }
  if (found.rows.empty()) {
    throw ConfigError(
        fmt::format("{}: no such key or score, the nearest is {}", key, nearest_name(key)));
  }
  print_result(common, {{"schema", 1}, {"status", "done"}, {"found", found.rows}}, found.text);
  return kExitDone;
}

}  // namespace glint
