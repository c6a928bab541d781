// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "cli/shell/usage.h"

namespace glint {

/// glint(1): the program and its verbs, as source of man (groff_man(7)).
std::string man_page(const ProgramUsage& program, const std::string& version);

/// glint-run(1): a verb.
std::string man_page(const ProgramUsage& program,
                     const VerbUsage& verb,
                     const std::string& version);

}  // namespace glint
