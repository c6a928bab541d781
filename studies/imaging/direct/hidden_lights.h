// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sums look at few places of a light: where another light covers some of them the share that is
// covered is told too coarsely (a tenth of a bar's light behind a ring, 0.02 of full scale).
#pragma once

#include <optional>

#include "core/error.h"
#include "simulator/render/path_tracing/physical_scene.h"

namespace glint {

/// With the key "lighting.<name>" of a light that another one, or another part of it, might hide
/// from some point of the part's bounding box; on the safe side (hideable_emitters.h). More than
/// kMaxPartedEmitters are refused as well.
std::optional<Problem> hidden_lights_problem(const PhysicalScene& scene);

/// @throws ConfigError  hidden_lights_problem()
void check_lights_unhidden(const PhysicalScene& scene);

}  // namespace glint
