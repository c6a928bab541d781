// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate_cell/validate_cell_run.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text.h"
#include "studies/acquire/acquire_plan.h"
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

/// Names with commas between them, but for those that are left out.
std::string others_of(const std::vector<std::string>& names,
                      const std::vector<LeftOutDesign>& left_out) {
  std::vector<std::string> others;
  std::ranges::copy_if(names, std::back_inserter(others), [&](const std::string& name) {
    return std::ranges::find(left_out, name, &LeftOutDesign::name) == left_out.end();
  });
  return join(others, ",");
}

/// Takes the pictures of the designs, as far as there are any.
class PicturesOfDesigns {
 public:
  PicturesOfDesigns(const ValidateOptions& validate,
                    const AcquireOptions& driven,
                    const MotionPermit& permit)
      : validate_(validate),
        driven_(driven),
        permit_(permit),
        prototypes_(MountedPrototypes::in_run(validate.run, driven.mounted)) {}

  /// @return what was told of the one that ends everything; null: none did
  Json take(const std::vector<std::string>& names) {
    std::vector<fs::path> scenes;
    for (const std::string& name : names) {
      scenes.push_back(validate_.run / name / "scene.toml");
    }
    while (!scenes.empty()) {
      const auto next = scenes.begin() + static_cast<std::ptrdiff_t>(prototypes_.next_of(scenes));
      const fs::path scene = *next;
      scenes.erase(next);
      Json ended = take_design(scene);
      if (!ended.is_null()) {
        return ended;
      }
    }
    return has_any_ ? Json(nullptr) : bare_;
  }

  const std::vector<LeftOutDesign>& left_out() const { return left_out_; }

 private:
  /// Views that cannot be taken, and pictures that were rejected, are told beside those that were:
  /// only who stopped or waits ends everything.
  Json take_design(const fs::path& scene) {
    const std::string name = scene.parent_path().lexically_relative(validate_.run).string();
    AcquireOptions acquire = driven_;
    acquire.source = scene;
    acquire.out = validate_.pictures / name;
    try {
      Json taken = acquire_pictures(acquire, prototypes_, permit_);
      taken["design"] = name;
      taken["agreement"] = nullptr;
      if (taken["ok"] == false && taken["status"] != "partial") {
        return taken;
      }
      const bool has_pictures = taken["counts"]["accepted"].get<int>() > 0;
      has_any_ = has_any_ || has_pictures;
      if (!has_pictures && bare_.is_null()) {
        bare_ = std::move(taken);
      }
    } catch (const NoViewTaken& error) {
      left_out_.push_back({.name = name, .reason = error.what()});
    }
    return nullptr;
  }

  const ValidateOptions& validate_;
  const AcquireOptions& driven_;
  const MotionPermit& permit_;
  MountedPrototypes prototypes_;
  std::vector<LeftOutDesign> left_out_;
  Json bare_;  ///< what was told of the first design without any accepted picture
  bool has_any_ = false;
};

}  // namespace

Json validate_in_cell(const ValidateCellOptions& options, const MotionPermit& permit) {
  ValidateOptions validate = options.validate;
  if (validate.pictures.empty()) {
    validate.pictures = fs::absolute(beside_run(validate.run) / "acquired");
  }
  if (validate.out.empty()) {
    check_default_validate_folder(validate.run, validate.pictures);
  }
  const std::vector<std::string> names = wanted_designs(validate);
  check_before_pictures(validate.run, validate.out, validate.calibration, names);
  PicturesOfDesigns pictures(validate, options.acquire, permit);
  Json ended = pictures.take(names);
  if (!ended.is_null()) {
    return ended;
  }
  validate.left_out = pictures.left_out();
  if (validate.left_out.size() == names.size()) {
    throw ConfigError(validate.left_out.front().reason);
  }
  if (!validate.left_out.empty()) {
    validate.designs = others_of(names, validate.left_out);
  }
  return validate_run(validate);
}

}  // namespace glint
