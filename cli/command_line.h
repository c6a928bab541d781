// SPDX-License-Identifier: GPL-3.0-or-later
//
// What each verb takes on the command line.
#pragma once

#include <functional>

#include "cli/commands.h"

namespace CLI {
class App;
}  // namespace CLI

namespace glint {

/// What was asked for on the command line.
struct CommandLine {
  CommonArguments common;
  StudyArguments study;
  ImprintArguments imprint;
  InspectArguments inspect;
  CalibrateArguments calibrate;
  CellArguments cell;
  ReportArguments report;
  PartArguments part;
  NewArguments fresh;
  ExplainArguments explain;
  HelpArguments help;
  std::function<int(const CommandLine&)> command;  ///< of the verb that was given
};

/// Adds all verbs but help.
/// @param line  receives what is given; outlives the app
void add_verbs(CLI::App& app, CommandLine& line);

}  // namespace glint
