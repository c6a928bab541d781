// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "studies/stability/stability_sweeps.h"

namespace glint::stability {

/// Sweeps of part, defects, view and path tracing, of two designs and of switches.
std::vector<Sweep> part_sweeps();

}  // namespace glint::stability
