// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a run's designs get to the real cell: the commands that acquire their pictures and validate.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/definition/study.h"

namespace glint {

/// The designs that [validate] of the study names, else the winner and all prototypes.
std::vector<std::string> designs_to_validate(const Study& study);

/// One `glint acquire` for each design that the run has written, then `glint validate`, each as a
/// shell takes it from where `run` is relative to. Pictures and report go beside the run. Nothing
/// without [validate].
/// @param run      folder of the run
/// @param cell     the cell's file, or what stands for it
/// @param driving  more options of `glint acquire`, each with a space before it
std::vector<std::string> validation_steps(const Study& study,
                                          const std::filesystem::path& run,
                                          const std::filesystem::path& cell,
                                          const std::string& driving = "");

/// The folder that a run lies in, as it is named: "" of "run" and "run/", the full path of ".".
std::filesystem::path beside_run(const std::filesystem::path& run);

}  // namespace glint
