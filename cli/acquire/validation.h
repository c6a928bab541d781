// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint validate`, with pictures that are there or that the robot takes: its arguments, and what
// is told of its result.
#pragma once

#include <filesystem>
#include <string>

#include "cli/acquire/acquire.h"
#include "core/progress.h"

namespace glint {

struct ValidationArguments {
  AcquireArguments acquire;  ///< with a cell the robot takes the pictures; its out is the results'
  std::filesystem::path run;
  std::filesystem::path pictures;
  std::filesystem::path calibration;
  std::string designs;
  bool is_refitting = false;
  int threads = 1;
};

/// @throws ConfigError with a cell, but without --move, before any file is read and any address is
///         looked up; with neither cell nor pictures
AcquireAnswer run_validation(const ValidationArguments& arguments, Progress::Style progress);

}  // namespace glint
