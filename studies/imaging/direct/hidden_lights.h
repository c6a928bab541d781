// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/render/path_tracing/physical_scene.h"

namespace glint {

/// Sums look at few places of a light: where another light covers some of them the share that is
/// covered is told too coarsely (a tenth of a bar's light behind a ring, 0.02 of full scale).
/// @throws ConfigError  beginning with "lighting.<name>" of a light that another one might hide
/// from
///         some point of the part's bounding box; on the safe side (hideable_emitters())
void check_lights_unhidden(const PhysicalScene& scene);

}  // namespace glint
