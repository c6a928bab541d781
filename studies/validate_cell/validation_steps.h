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

/// One `glint acquire` for each design, then `glint validate`. Nothing without [validate].
/// @param run   folder of the run
/// @param cell  the cell's file, or what stands for it
std::vector<std::string> validation_steps(const Study& study,
                                          const std::filesystem::path& run,
                                          const std::filesystem::path& cell);

}  // namespace glint
