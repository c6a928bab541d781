// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "studies/frontier/frontier.h"

namespace glint {

/// Error of the frames against CPU time, both by powers of ten.
std::string frontier_svg(const Frontier& frontier, const std::string& title);

}  // namespace glint
