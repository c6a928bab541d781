// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/light_difference.h"

#include <map>
#include <set>

#include <fmt/format.h>

#include "studies/acquire/mounted_prototypes.h"
#include "studies/definition/study.h"

namespace glint {
namespace {

using LightTables = std::map<std::string, std::string>;

/// The first light that has another table, or is in one of them only; empty: none.
std::string first_different(const LightTables& one, const LightTables& other) {
  std::set<std::string> names;
  for (const LightTables& tables : {one, other}) {
    for (const auto& [light, table] : tables) {
      names.insert(light);
    }
  }
  for (const std::string& light : names) {
    const auto here = one.find(light);
    const auto there = other.find(light);
    if (here == one.end() || there == other.end() || here->second != there->second) {
      return light;
    }
  }
  return {};
}

}  // namespace

std::string light_difference(const SceneSettings& one, const SceneSettings& other) {
  const std::string built = first_different(built_lights(one), built_lights(other));
  if (!built.empty()) {
    return fmt::format("[lighting.{}] is built differently", built);
  }
  const std::string set = first_different(set_lights(one), set_lights(other));
  return set.empty() ? set : fmt::format("[lighting.{}] shines at another power", set);
}

std::string light_difference(const std::filesystem::path& acquired, const SceneSettings& wanted) {
  return light_difference(load_study(acquired / "scene.toml", {}).scene, wanted);
}

}  // namespace glint
