// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint plan`: the views of a scene as a tour of a cell's arm. Moves nothing and connects to
// nothing.
//
//   OUT/plan.json      what was decided; docs/plan.md
//   OUT/plan.csv       a row a view
//   OUT/scene.toml  cell.toml   what it was decided for, with full paths
//   OUT/pictures/view_01.png    arm and cell at each planned view
//   OUT/report.html  run.json
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"

namespace glint {

struct PlanRunOptions {
  std::filesystem::path cell;
  std::filesystem::path out;
  std::filesystem::path run;  ///< whose designs the scene is one of; empty: the one it lies in
  int threads = 1;
};

/// @return the object of plan.json with "folder" and "report"
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json plan_study(const Study& study, const PlanRunOptions& options);

}  // namespace glint
