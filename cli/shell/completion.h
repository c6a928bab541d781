// SPDX-License-Identifier: GPL-3.0-or-later
//
// Completion of verbs, options, choices, keys and files in the shells people use.
#pragma once

#include <span>
#include <string>

#include "cli/shell/usage.h"

namespace glint {

/// @param keys  of study files: completed for values named KEY and KEY=VALUE
std::string bash_completion(const ProgramUsage& program, std::span<const std::string> keys);
std::string zsh_completion(const ProgramUsage& program, std::span<const std::string> keys);
std::string fish_completion(const ProgramUsage& program, std::span<const std::string> keys);

}  // namespace glint
