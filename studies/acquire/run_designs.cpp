// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/run_designs.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <string>

#include "core/error.h"
#include "studies/definition/study.h"
#include "studies/output/run_folder.h"
#include "studies/output/staged_folder.h"

namespace glint::acquire_detail {
namespace {

namespace fs = std::filesystem;
using Design = MountedPrototypes::Design;

Design read_design(const std::string& name, const fs::path& file) {
  try {
    const SceneSettings scene = load_study(file, {}).scene;
    return {.name = name, .lights = built_lights(scene), .set = set_lights(scene)};
  } catch (const Error&) {
    return {.name = name, .lights = {}, .is_read = false};
  }
}

bool is_within(const fs::path& path, const fs::path& folder) {
  const fs::path way = path.lexically_relative(folder);
  return !way.empty() && *way.begin() != "..";
}

/// A folder in the run, not in a design of it: what lies there are the design's other scenes.
bool holds_designs(const fs::path& folder, const fs::path& run) {
  if (!is_within(folder, run)) {
    return false;
  }
  for (fs::path above = folder; above != run; above = above.parent_path()) {
    if (fs::exists(above / kDesignScene)) {
      return false;
    }
  }
  return true;
}

std::string name_in(const fs::path& run, const fs::path& path) {
  return is_within(path, run) ? path.lexically_relative(run).generic_string()
                              : path.generic_string();
}

}  // namespace

fs::path without_slash(const fs::path& folder) {
  return folder.has_filename() ? folder : folder.parent_path();
}

fs::path design_folder(const fs::path& scene) {
  if (scene.empty()) {
    return {};
  }
  const fs::path file = fs::absolute(scene).lexically_normal();
  return without_slash(fs::is_directory(file) ? file : file.parent_path());
}

std::vector<Design> designs_in(const fs::path& run, const fs::path& folder) {
  std::set<fs::path> folders;
  for (const fs::path& above : {run, run / "front", holds_designs(folder, run) ? folder : run}) {
    std::ranges::copy(sorted_entries(above), std::inserter(folders, folders.end()));
  }
  std::vector<Design> designs;
  for (const fs::path& entry : folders) {
    const bool is_design = !entry.filename().string().starts_with(".");
    if (is_design && fs::exists(entry / kDesignScene)) {
      designs.push_back(read_design(name_in(run, entry), entry / kDesignScene));
    }
  }
  return designs;
}

Design design_of(const fs::path& held,
                 const PlanOrigin& origin,
                 const std::vector<Design>& designs) {
  const std::string around = name_in(origin.run, design_folder(origin.scene));
  if (!fs::exists(origin.run / kRunStudy)) {
    return {
        .name = around, .lights = {}, .is_read = false, .unread = "its run is not there any more"};
  }
  const fs::path file = held.empty() ? held : fs::absolute(held).lexically_normal();
  const auto home = std::ranges::find(designs, around, &Design::name);
  const bool is_of_design = home != designs.end() && origin.scene.filename() == kDesignScene;
  if (is_of_design && (file == origin.scene || without_links(file) == origin.scene)) {
    return *home;
  }
  const Design own =
      read_design(name_in(origin.run, is_of_design && !file.empty() ? file : origin.scene), file);
  const auto is_alike = [&own](const Design& design) {
    return own.is_read && design.is_read && design.lights == own.lights && design.set == own.set;
  };
  if (home != designs.end() && is_alike(*home)) {
    return *home;
  }
  const auto alike = std::ranges::find_if(designs, is_alike);
  return alike == designs.end() ? own : *alike;
}

}  // namespace glint::acquire_detail
