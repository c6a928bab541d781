// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/mounted_prototypes.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/config/config.h"
#include "core/error.h"
#include "core/text.h"
#include "studies/acquire/run_designs.h"
#include "studies/acquire/source_files.h"
#include "studies/definition/scene_lights.h"
#include "studies/imaging/path_lights.h"
#include "studies/output/run_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using LightTables = std::map<std::string, std::string>;

/// The tables of all lights, wherever the stage has taken the stripes.
LightTables tables_of(SceneSettings scene) {
  scene.tunnel.offset_mm = 0.0;
  const ConfigNode tables = write_lighting(scene);
  LightTables texts;
  for (std::size_t i = 0; i < tables.names.size(); ++i) {
    texts[tables.names[i]] = to_toml(tables.items[i]);
  }
  return texts;
}

std::vector<std::string> without_slashes(std::vector<std::string> names) {
  for (std::string& name : names) {
    while (name.ends_with('/')) {
      name.pop_back();
    }
  }
  return names;
}

bool has(const LightTables& lights, const std::string& light, const std::string& text) {
  const auto found = lights.find(light);
  return found != lights.end() && found->second == text;
}

/// The run that a folder of designs is, or is a part of as RUN/front is; empty: none.
fs::path run_of(const fs::path& folder) {
  for (const fs::path& run : {folder, folder.parent_path()}) {
    if (!run.empty() && fs::exists(run / kRunStudy)) {
      return run;
    }
  }
  return {};
}

}  // namespace

std::map<std::string, std::string> built_lights(const SceneSettings& scene) {
  SceneSettings unit = scene;
  unit.lights = without_powers(scene.lights);
  unit.idle_lights = without_powers(scene.idle_lights);
  return tables_of(std::move(unit));
}

std::map<std::string, std::string> set_lights(const SceneSettings& scene) {
  LightTables tables = tables_of(scene);
  const std::vector<std::string> shining = shining_lights(scene);
  std::erase_if(tables, [&shining](const auto& light) {
    return std::ranges::find(shining, light.first) == shining.end();
  });
  return tables;
}

MountedPrototypes::MountedPrototypes(std::vector<Design> designs,
                                     const std::vector<std::string>& mounted)
    : designs_(std::move(designs)) {
  for (const std::string& name : without_slashes(mounted)) {
    take_named(name);
  }
}

void MountedPrototypes::take_named(const std::string& name) {
  const auto take = [&name](const LightTables& wanted, const char* how, LightTables& known) {
    for (const auto& [light, text] : wanted) {
      if (!known.emplace(light, text).second && known.at(light) != text) {
        throw ConfigError(
            fmt::format("--mounted {}: another design that is named has [lighting.{}] "
                        "{}: one of them can be mounted",
                        name,
                        light,
                        how));
      }
    }
  };
  const Design& design = named(name);
  take(wanted(design), "built differently, or one of them has none", mounted_);
  take(design.set, "at another power", set_);
  last_ = name;
}

MountedPrototypes MountedPrototypes::beside(const fs::path& source,
                                            const std::vector<std::string>& mounted,
                                            const fs::path& made_from) {
  const PlanOrigin origin = origin_of(made_from.empty() ? source : made_from);
  if (origin.run.empty()) {
    return {{}, mounted};
  }
  const fs::path folder = acquire_detail::design_folder(origin.scene).parent_path();
  std::vector<Design> designs = acquire_detail::designs_in(origin.run, folder);
  const Design own = acquire_detail::design_of(files_of(source).scene, origin, designs);
  const auto same = std::ranges::find(designs, own.name, &Design::name);
  if (same == designs.end()) {
    designs.push_back(own);
  } else {
    *same = own;  // as this source has it: it may not be read where the design can
  }
  MountedPrototypes prototypes(std::move(designs), mounted);
  prototypes.run_ = origin.run;
  prototypes.source_ = fs::absolute(source).lexically_normal();
  prototypes.source_name_ = own.name;
  return prototypes;
}

MountedPrototypes MountedPrototypes::in_run(const fs::path& run,
                                            const std::vector<std::string>& mounted) {
  const fs::path folder = acquire_detail::without_slash(fs::absolute(run).lexically_normal());
  const fs::path found = run_of(folder);
  const fs::path base = found.empty() ? folder : found;
  MountedPrototypes prototypes(acquire_detail::designs_in(base, folder), mounted);
  prototypes.run_ = base;
  return prototypes;
}

std::string MountedPrototypes::design_in(const fs::path& scene) const {
  if (!source_name_.empty() && fs::absolute(scene).lexically_normal() == source_) {
    return source_name_;
  }
  const fs::path folder = acquire_detail::design_folder(scene);
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
MountedPrototypes::LightTables MountedPrototypes::wanted(const Design& design) const {
  if (!design.is_read) {
    return {};
  }
  LightTables lights = design.lights;
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

/// Whether designs that have a light built alike let it shine at different powers.
bool MountedPrototypes::is_set_by_hand(const std::string& light) const {
  LightTables powers;  // by how the light is built
  return std::ranges::any_of(designs_, [&](const Design& design) {
    const auto set = design.set.find(light);
    return !design.is_read ||
           (set != design.set.end() &&
            powers.emplace(design.lights.at(light), set->second).first->second != set->second);
  });
}

/// Lights of a design that have to be mounted or set, and those that have to be taken down for it.
MountedPrototypes::Exchange MountedPrototypes::exchange_for(const Design& design) const {
  Exchange exchange;
  for (const auto& [light, table] : wanted(design)) {
    const auto set = design.set.find(light);
    if (!has(mounted_, light, table) && is_exchanged(light)) {
      (table.empty() ? exchange.down : exchange.up).push_back(light);
    } else if (set != design.set.end() && !has(set_, light, set->second) && is_set_by_hand(light)) {
      exchange.set.push_back(light);
    }
  }
  return exchange;
}

std::optional<std::string> MountedPrototypes::wish(const std::string& design) const {
  const Design* wished = find(design);
  if (wished == nullptr || (!wished->is_read && last_ == design)) {
    return std::nullopt;
  }
  const auto [up, set, down] = exchange_for(*wished);
  if (wished->is_read && up.empty() && set.empty() && down.empty()) {
    return std::nullopt;
  }
  std::vector<std::string> steps;
  if (!wished->is_read || !up.empty() || set.empty()) {
    const std::string what = wished->is_read ? join(up, ", ") : wished->unread;
    steps.push_back(
        fmt::format("mount the prototype of {}{}", design, what.empty() ? "" : " (" + what + ")"));
  }
  if (!set.empty()) {
    steps.push_back(fmt::format("set the power of {} as {} has it", join(set, ", "), design));
  }
  if (!down.empty()) {
    steps.push_back("take down " + join(down, ", "));
  }
  return join(steps, ", ") + ", and leave the arm's reach";
}

std::size_t MountedPrototypes::next_of(const std::vector<fs::path>& scenes) const {
  const auto next = std::ranges::find_if(
      scenes, [this](const fs::path& scene) { return !wish(design_in(scene)); });
  return next == scenes.end() ? 0 : static_cast<std::size_t>(next - scenes.begin());
}

void MountedPrototypes::mount(const std::string& design) {
  const Design* mounted = find(design);
  if (mounted == nullptr) {
    return;
  }
  const LightTables now = wanted(*mounted);
  std::erase_if(set_, [&](const auto& light) {  // another prototype has been set by nobody
    const auto before = mounted_.find(light.first);
    return before == mounted_.end() || !has(now, light.first, before->second);
  });
  mounted_ = now;
  for (const auto& [light, text] : mounted->set) {
    set_[light] = text;
  }
  last_ = design;
}

}  // namespace glint
