// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/mounted_prototypes.h"

#include <algorithm>
#include <iterator>
#include <set>

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

constexpr const char* kStudy = "study.resolved.toml";

fs::path without_slash(const fs::path& folder) {
  return folder.has_filename() ? folder : folder.parent_path();
}

/// RUN/NAME of RUN/NAME/scene.toml, RUN/NAME and RUN/NAME/; empty: none is named.
fs::path design_folder(const fs::path& scene) {
  if (scene.empty()) {
    return {};
  }
  const fs::path file = fs::absolute(scene).lexically_normal();
  return without_slash(fs::is_directory(file) ? file : file.parent_path());
}

/// The run that a folder of designs is, or is a part of as RUN/front is; empty: none.
fs::path run_of(const fs::path& folder) {
  for (const fs::path& run : {folder, folder.parent_path()}) {
    if (!run.empty() && fs::exists(run / kStudy)) {
      return run;
    }
  }
  return {};
}

MountedPrototypes::Design read_design(const std::string& name, const fs::path& scene) {
  try {
    return {.name = name, .lights = built_lights(load_study(scene, {}).scene)};
  } catch (const Error&) {
    return {.name = name, .lights = {}, .is_read = false};
  }
}

/// Of RUN/NAME, RUN/front/NAME, and FOLDER/NAME.
std::vector<MountedPrototypes::Design> designs_in(const fs::path& run, const fs::path& folder) {
  std::set<fs::path> folders;
  for (const fs::path& above : {run, run / "front", folder}) {
    std::ranges::copy(sorted_entries(above), std::inserter(folders, folders.end()));
  }
  std::vector<MountedPrototypes::Design> designs;
  for (const fs::path& entry : folders) {
    const bool is_design = !entry.filename().string().starts_with(".");
    if (is_design && fs::exists(entry / "scene.toml")) {
      designs.push_back(
          read_design(entry.lexically_relative(run).generic_string(), entry / "scene.toml"));
    }
  }
  return designs;
}

std::vector<std::string> without_slashes(std::vector<std::string> names) {
  for (std::string& name : names) {
    while (name.ends_with('/')) {
      name.pop_back();
    }
  }
  return names;
}

}  // namespace

std::map<std::string, std::string> built_lights(const SceneSettings& scene) {
  SceneSettings unit = scene;
  unit.lights = without_powers(scene.lights);
  unit.idle_lights = without_powers(scene.idle_lights);
  unit.tunnel.offset_mm = 0.0;
  const ConfigNode tables = write_lighting(unit);
  std::map<std::string, std::string> built;
  for (std::size_t i = 0; i < tables.names.size(); ++i) {
    built[tables.names[i]] = to_toml(tables.items[i]);
  }
  return built;
}

MountedPrototypes::MountedPrototypes(std::vector<Design> designs,
                                     const std::vector<std::string>& mounted)
    : designs_(std::move(designs)) {
  for (const std::string& name : without_slashes(mounted)) {
    for (const auto& [light, table] : wanted(named(name))) {
      if (!mounted_.emplace(light, table).second && mounted_.at(light) != table) {
        throw ConfigError(
            fmt::format("--mounted {}: another design that is named has [lighting.{}] built "
                        "differently, or one of them has none: one of them can be mounted",
                        name,
                        light));
      }
    }
    last_ = name;
  }
}

MountedPrototypes MountedPrototypes::beside(const fs::path& scene,
                                            const std::vector<std::string>& mounted) {
  const fs::path folder = design_folder(scene).parent_path();
  return run_of(folder).empty() ? MountedPrototypes({}, mounted) : in_run(folder, mounted);
}

MountedPrototypes MountedPrototypes::in_run(const fs::path& run,
                                            const std::vector<std::string>& mounted) {
  const fs::path folder = without_slash(fs::absolute(run).lexically_normal());
  const fs::path found = run_of(folder);
  const fs::path base = found.empty() ? folder : found;
  MountedPrototypes prototypes(designs_in(base, folder), mounted);
  prototypes.run_ = base;
  return prototypes;
}

std::string MountedPrototypes::design_in(const fs::path& scene) const {
  const fs::path folder = design_folder(scene);
  return run_.empty() ? folder.filename().string()
                      : folder.lexically_relative(run_).generic_string();
}

const MountedPrototypes::Design* MountedPrototypes::find(const std::string& name) const {
  const auto found = std::ranges::find(designs_, name, &Design::name);
  return found == designs_.end() ? nullptr : &*found;
}

const MountedPrototypes::Design& MountedPrototypes::named(const std::string& mounted) const {
  if (const Design* design = find(mounted)) {
    return *design;
  }
  std::vector<std::string> names;
  for (const Design& design : designs_) {
    names.push_back(design.name);
  }
  throw ConfigError(
      fmt::format("--mounted {}: there is no such design, {}",
                  mounted,
                  names.empty() ? "the scene lies in no run" : "there are " + join(names, ", ")));
}

/// How each light that any design has is built in this one; "": it has none. Nothing of a design
/// that cannot be read.
std::map<std::string, std::string> MountedPrototypes::wanted(const Design& design) const {
  if (!design.is_read) {
    return {};
  }
  std::map<std::string, std::string> lights = design.lights;
  for (const Design& other : designs_) {
    for (const auto& [light, table] : other.lights) {
      lights.emplace(light, "");
    }
  }
  return lights;
}

bool MountedPrototypes::is_exchanged(const std::string& light) const {
  const auto built = [&light](const Design& design) {
    const auto found = design.lights.find(light);
    return found == design.lights.end() ? std::string() : found->second;
  };
  return std::ranges::any_of(designs_, [&](const Design& design) {
    return !design.is_read || built(design) != built(designs_.front());
  });
}

/// Lights of a design that have to be mounted, and those that have to be taken down for it.
MountedPrototypes::Exchange MountedPrototypes::exchange_for(const Design& design) const {
  Exchange exchange;
  for (const auto& [light, table] : wanted(design)) {
    const auto mounted = mounted_.find(light);
    const bool is_known = mounted != mounted_.end() && mounted->second == table;
    if (!is_known && is_exchanged(light)) {
      (table.empty() ? exchange.down : exchange.up).push_back(light);
    }
  }
  return exchange;
}

std::optional<std::string> MountedPrototypes::wish(const std::string& design) const {
  const Design* wished = find(design);
  if (wished == nullptr || (!wished->is_read && last_ == design)) {
    return std::nullopt;
  }
  const auto [up, down] = exchange_for(*wished);
  if (wished->is_read && up.empty() && down.empty()) {
    return std::nullopt;
  }
  const std::string what = wished->is_read ? join(up, ", ") : "its scene cannot be read";
  return fmt::format("mount the prototype of {}{}{}, and leave the arm's reach",
                     design,
                     what.empty() ? "" : " (" + what + ")",
                     down.empty() ? "" : ", take down " + join(down, ", "));
}

std::size_t MountedPrototypes::next_of(const std::vector<fs::path>& scenes) const {
  const auto next = std::ranges::find_if(
      scenes, [this](const fs::path& scene) { return !wish(design_in(scene)); });
  return next == scenes.end() ? 0 : static_cast<std::size_t>(next - scenes.begin());
}

void MountedPrototypes::mount(const std::string& design) {
  if (const Design* mounted = find(design)) {
    mounted_ = wanted(*mounted);
    last_ = design;
  }
}

}  // namespace glint
