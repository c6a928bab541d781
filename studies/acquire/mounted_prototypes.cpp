// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/mounted_prototypes.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/config/config.h"
#include "core/error.h"
#include "core/text.h"
#include "studies/definition/scene_lights.h"
#include "studies/definition/study.h"
#include "studies/imaging/path_lights.h"
#include "studies/output/staged_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

/// RUN/NAME of RUN/NAME/scene.toml, RUN/NAME and RUN/NAME/; empty: none is named.
fs::path design_folder(const fs::path& scene) {
  if (scene.empty()) {
    return {};
  }
  const fs::path file = fs::absolute(scene).lexically_normal();
  const fs::path folder = fs::is_directory(file) ? file : file.parent_path();
  return folder.has_filename() ? folder : folder.parent_path();
}

}  // namespace

std::map<std::string, std::string> built_lights(const SceneSettings& scene) {
  SceneSettings unit = scene;
  unit.lights = without_powers(scene.lights);
  const ConfigNode tables = write_lighting(unit);
  std::map<std::string, std::string> built;
  for (const std::string& light : shining_lights(scene)) {
    built[light] = to_toml(*tables.find(light));
  }
  return built;
}

MountedPrototypes::MountedPrototypes(std::vector<Design> designs,
                                     const std::vector<std::string>& mounted)
    : designs_(std::move(designs)) {
  for (const std::string& name : mounted) {
    for (const auto& [light, table] : design_of(name).lights) {
      if (!mounted_.emplace(light, table).second && mounted_.at(light) != table) {
        throw ConfigError(
            fmt::format("--mounted {}: another design that is named has [lighting.{}] built "
                        "differently, one of "
                        "them can be mounted",
                        name,
                        light));
      }
    }
  }
}

MountedPrototypes MountedPrototypes::beside(const fs::path& scene,
                                            const std::vector<std::string>& mounted) {
  const fs::path run = design_folder(scene).parent_path();
  std::vector<Design> designs;
  if (!run.empty() && fs::exists(run / "study.resolved.toml")) {
    for (const fs::path& entry : sorted_entries(run)) {
      const bool is_design = !entry.filename().string().starts_with(".");
      if (is_design && fs::exists(entry / "scene.toml")) {
        designs.push_back({.name = entry.filename().string(),
                           .lights = built_lights(load_study(entry / "scene.toml", {}).scene)});
      }
    }
  }
  return {std::move(designs), mounted};
}

std::string MountedPrototypes::design_in(const fs::path& scene) {
  return design_folder(scene).filename().string();
}

const MountedPrototypes::Design& MountedPrototypes::design_of(const std::string& name) const {
  const auto found = std::ranges::find(designs_, name, &Design::name);
  if (found == designs_.end()) {
    std::vector<std::string> names;
    for (const Design& design : designs_) {
      names.push_back(design.name);
    }
    throw ConfigError(
        fmt::format("--mounted {}: there is no such design, {}",
                    name,
                    names.empty() ? "the scene lies in no run" : "there are " + join(names, ", ")));
  }
  return *found;
}

bool MountedPrototypes::is_exchanged(const std::string& light) const {
  const std::string* first = nullptr;
  for (const Design& design : designs_) {
    const auto found = design.lights.find(light);
    if (found == design.lights.end()) {
      continue;
    }
    if (first != nullptr && found->second != *first) {
      return true;
    }
    first = &found->second;
  }
  return false;
}

std::optional<std::string> MountedPrototypes::wish(const std::string& design) const {
  if (designs_.empty()) {
    return std::nullopt;
  }
  std::vector<std::string> missing;
  for (const auto& [light, table] : design_of(design).lights) {
    const auto mounted = mounted_.find(light);
    const bool is_there = mounted != mounted_.end() && mounted->second == table;
    if (!is_there && is_exchanged(light)) {
      missing.push_back(light);
    }
  }
  if (missing.empty()) {
    return std::nullopt;
  }
  return fmt::format(
      "mount the prototype of {} ({}), and leave the arm's reach", design, join(missing, ", "));
}

void MountedPrototypes::mount(const std::string& design) {
  for (const auto& [light, table] : design_of(design).lights) {
    mounted_[light] = table;
  }
}

}  // namespace glint
