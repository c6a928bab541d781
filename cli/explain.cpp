// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "core/text.h"
#include "metrics/scores.h"
#include "studies/scene.h"

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
  if (parts.size() >= 2 && parts[0] == "lighting") {
    parts[1] = "tunnel";
  }
  if (parts.size() >= 2 && parts[0] == "defects" && parts[1] != "bump" && parts[1] != "scratch") {
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

}  // namespace

int explain_command(const std::string& key, const CommonArguments& common) {
  const std::string wanted = table_name(key);
  Json found = Json::array();
  std::string text;
  std::vector<std::string> names;
  for (const KeyRow& row : all_keys()) {
    names.push_back(row.path);
    if (row.path == wanted || row.path.starts_with(wanted + ".")) {
      found.push_back(row_json(row));
      text += row_text(row);
    }
  }
  if (const auto doc = explain_score(key)) {
    found.push_back({{"score", key}, {"doc", std::string(*doc)}});
    text += fmt::format("{}\n  {}\n  a score\n", key, *doc);
  }
  for (const ScoreDoc& doc : score_docs()) {
    names.emplace_back(doc.name);
  }
  if (found.empty()) {
    throw ConfigError(
        fmt::format("{}: no such key or score, the nearest is {}", key, nearest(key, names)));
  }
  print_result(common, {{"schema", 1}, {"status", "done"}, {"found", found}}, text);
  return kExitDone;
}

}  // namespace glint
