// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is to be taken from where: a plan's views and paths, or those of the cell's own file, with
// the lights and the scan of a scene.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "hardware/acquisition/acquisition.h"
#include "hardware/planning/view_plan.h"
#include "studies/acquire/picture_grounds.h"
#include "studies/cell/cell_file.h"
#include "studies/definition/scene.h"

namespace glint {

/// The arm gets to none of the views.
class NoViewTaken : public ConfigError {
 public:
  using ConfigError::ConfigError;
};

/// What is named on the command line.
struct AcquireSource {
  std::optional<SceneSettings> scene;
  std::optional<ViewPlan> plan;  ///< none: of a scene that lies in the cell its viewpoints, else
                                 ///< the cell's own views
  bool is_plan_free = false;     ///< somebody has looked at its paths in this cell already
};

/// @param path  a scene or study, plan.json, or a folder that holds plan.json or scene.toml; empty:
///              nothing but the cell
AcquireSource read_source(const std::filesystem::path& path);

/// What of a source and a cell decides which pictures are taken.
struct AcquireWork {
  ViewPlan views;
  AcquisitionPlan plan;
  int num_positions = 1;  ///< of each view
  ScanSteps steps;        ///< of the scene's scan; to the first one: of a linear stage alone
  std::string digest;     ///< plan_digest()
  PictureGrounds grounds;
};

/// @throws NoViewTaken; ConfigError when paths do not join, a leg leaves the box, the cell lacks a
///         light or a stage that the scene has, or its stage has no place for each position;
///         IoError as picture_grounds()
AcquireWork work_of(const AcquireSource& source, const Cell& cell, double speed_share);

/// How well a standstill is known, along and about each axis: a third of the arm's repeatability as
/// its maker states it (ISO 9283), and what that is on a lever of half its reach.
struct PoseSigma {
  double position_mm = 0.0;
  double rotation_rad = 0.0;
};

PoseSigma pose_sigma_of(ArmModel model);

}  // namespace glint
