// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint validate`, with pictures that are there or that the robot takes: its arguments, and what
// is told of its result.
#pragma once

#include <filesystem>
#include <string>

#include "cli/acquire/acquire.h"
#include "core/progress.h"
#include "studies/definition/study.h"

namespace glint {

struct ValidationArguments {
  AcquireArguments acquire;  ///< with a cell the robot takes the pictures; its out is the results'
  std::filesystem::path run;
  std::filesystem::path pictures;
  std::filesystem::path calibration;
  std::string designs;
  bool is_refitting = false;
  int threads = 1;
  std::string again = "the same command";  ///< that goes on when a prototype is mounted
};

/// The cell that is named on the command line, else by the study, if its scene lies in it; empty:
/// none. @throws ConfigError where the study's file is wrong; IoError
std::filesystem::path planned_cell(const Study& study, const AcquireArguments& driven);

/// How `glint run` ends on a study with [validate]: by the commands that validate, with a cell also
/// by a plan of each design's views, or the reason why there is none, and with --move by
/// validating.
/// @param run     folder of the run, which is done
/// @param driven  its cell, without --move planned_cell(), twin, --move, speed, confirmed lights
/// @return json: members of the run's result
AcquireAnswer end_of_run(const Study& study,
                         const std::filesystem::path& run,
                         const AcquireArguments& driven,
                         int threads,
                         Progress::Style progress);

/// @throws ConfigError with a cell, but without --move, before any file is read and any address is
///         looked up; with neither cell nor pictures
AcquireAnswer run_validation(const ValidationArguments& arguments, Progress::Style progress);

}  // namespace glint
