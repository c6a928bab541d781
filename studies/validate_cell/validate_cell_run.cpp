// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate_cell/validate_cell_run.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "studies/definition/study.h"
#include "studies/validate/validated_designs.h"
#include "studies/validate_cell/validation_steps.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Names of the designs whose pictures are wanted; each has its scene in the run.
std::vector<std::string> wanted_designs(const ValidateOptions& options) {
  std::vector<std::string> names = names_in(options.designs);
  if (names.empty()) {
    names = designs_to_validate(load_study(options.run / "study.resolved.toml", {}));
  }
  for (const std::string& name : names) {
    if (!fs::exists(options.run / name / "scene.toml")) {
      throw ConfigError("designs",
                        fmt::format("there is no design {} in {}", name, options.run.string()));
    }
  }
  return names;
}

}  // namespace

Json validate_in_cell(const ValidateCellOptions& options, const MotionPermit& permit) {
  ValidateOptions validate = options.validate;
  if (validate.pictures.empty()) {
    validate.pictures = (fs::absolute(validate.run) / ".").lexically_normal().parent_path();
    validate.pictures = validate.pictures.parent_path() / "acquired";
  }
  MountedPrototypes prototypes = MountedPrototypes::in_run(validate.run, options.acquire.mounted);
  std::vector<fs::path> scenes;
  for (const std::string& name : wanted_designs(validate)) {
    scenes.push_back(validate.run / name / "scene.toml");
  }
  while (!scenes.empty()) {
    const auto next = scenes.begin() + static_cast<std::ptrdiff_t>(prototypes.next_of(scenes));
    AcquireOptions acquire = options.acquire;
    acquire.source = *next;
    const fs::path name = next->parent_path().lexically_relative(validate.run);
    scenes.erase(next);
    acquire.out = validate.pictures / name;
    Json taken = acquire_pictures(acquire, prototypes, permit);
    // Views that cannot be taken, and pictures that were rejected, are told beside those that were.
    const bool has_pictures =
        taken["status"] == "partial" && taken["counts"]["accepted"].get<int>() > 0;
    if (taken["ok"] == false && !has_pictures) {
      taken["design"] = name.string();
      taken["agreement"] = nullptr;
      return taken;
    }
  }
  return validate_run(validate);
}

}  // namespace glint
