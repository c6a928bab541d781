// SPDX-License-Identifier: GPL-3.0-or-later
//
// plan.json: what `glint plan` decided, as others read it. Poses are six numbers, mm and rotation
// vector in rad; joints are degrees. docs/plan.md
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "hardware/planning/view_plan.h"

namespace glint {

/// A plan and what it was made for.
struct PlanFile {
  ViewPlan plan;
  std::filesystem::path scene;  ///< beside plan.json
  std::filesystem::path cell;
};

/// The object of plan.json. @param scene, cell  names of the files beside it
nlohmann::ordered_json plan_json(const ViewPlan& plan,
                                 const std::string& scene,
                                 const std::string& cell);

/// Writes plan.json: the file appears whole or not at all. @throws IoError
void write_plan(const PlanFile& file, const std::filesystem::path& path);

/// @param path  plan.json, or the folder that holds it
/// @return the same plan; its files' paths with the folder's before them
/// @throws ConfigError naming what is missing or no plan, IoError
PlanFile read_plan(const std::filesystem::path& path);

/// A row for each view, in the scene's order.
std::string plan_csv(const ViewPlan& plan);

}  // namespace glint
