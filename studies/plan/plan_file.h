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

/// Whose views were planned, with full paths.
struct PlanOrigin {
  std::filesystem::path scene;  ///< the file that was given; empty: not told
  std::filesystem::path run;    ///< folder of the run whose designs it is one of; empty: none
  bool is_told = true;          ///< false: by a plan of an earlier program, which tells neither
};

/// A plan and what it was made for.
struct PlanFile {
  ViewPlan plan;
  std::filesystem::path scene;  ///< beside plan.json
  std::filesystem::path cell;
  PlanOrigin origin = {};
  std::vector<std::string> notes = {};  ///< what was not looked at; not read again
};

/// The object of plan.json. Of scene and cell the names are written.
nlohmann::ordered_json plan_json(const PlanFile& file);

/// Writes plan.json: the file appears whole or not at all. @throws IoError
void write_plan(const PlanFile& file, const std::filesystem::path& path);

/// @param path  plan.json, or the folder that holds it
/// @return the same plan; its files' paths with the folder's before them. Plans of earlier programs
///         do not tell their origin
/// @throws ConfigError naming what is missing or no plan, IoError
PlanFile read_plan(const std::filesystem::path& path);

/// A row for each view, in the scene's order.
std::string plan_csv(const ViewPlan& plan);

}  // namespace glint
