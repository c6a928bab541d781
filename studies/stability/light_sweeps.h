// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "studies/stability/stability_sweeps.h"

namespace glint::stability {

/// Sweeps of sensor, stripes, scan and tunnel.
std::vector<Sweep> light_sweeps(const SweptScene& scene);

}  // namespace glint::stability
