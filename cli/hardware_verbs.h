// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/command_line.h"

namespace glint {

/// Adds the verbs about real cameras, robots and pictures.
/// @param line  as of add_verbs()
void add_hardware_verbs(CLI::App& app, CommandLine& line);

}  // namespace glint
