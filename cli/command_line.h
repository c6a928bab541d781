// SPDX-License-Identifier: GPL-3.0-or-later
//
// What each verb takes on the command line.
#pragma once

#include <functional>
#include <string>

#include "cli/acquire/acquire.h"
#include "cli/acquire/cell_calibration.h"
#include "cli/acquire/validation.h"
#include "cli/commands.h"
#include "cli/frontier.h"

namespace CLI {
class App;
}  // namespace CLI

namespace glint {

/// What was asked for on the command line.
struct CommandLine {
  CommonArguments common;
  StudyArguments study;
  FrontierArguments frontier;
  AcquireArguments driven_run;  ///< run --cell
  StabilityArguments stability;
  ImprintArguments imprint;
  InspectArguments inspect;
  CompareArguments compare;
  ValidationArguments validate;
  CalibrateArguments calibrate;
  CoverArguments cover;
  UndistortArguments undistort;
  CellArguments cell;
  AcquireArguments acquire;
  CellCalibrationArguments cell_calibration;  ///< calibrate --cell
  ViewPlanArguments plan;
  ReportArguments report;
  PartArguments part;
  NewArguments fresh;
  ExplainArguments explain;
  HelpArguments help;
  std::function<int(const CommandLine&)> command;  ///< of the verb that was given
};

/// Adds a verb with the options that all have.
/// @param what  one line for its help
/// @param example  for its help
/// @param command  runs it
CLI::App* add_verb(CLI::App& app,
                   const std::string& name,
                   const std::string& what,
                   const std::string& example,
                   CommandLine& line,
                   int (*command)(const CommandLine& line));

/// Adds the file of a study or scene, and --set.
/// @param file  what the verb takes, STUDY.toml or SCENE.toml
void add_study(CLI::App& verb, const std::string& file, StudyArguments& study);

/// Adds all verbs but help.
/// @param line  receives what is given; outlives the app
void add_verbs(CLI::App& app, CommandLine& line);

}  // namespace glint
