// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "defects/boolean/imprint.h"
#include "defects/boolean/imprint_state.h"
#include "defects/boolean/patch_assemble.h"
#include "defects/boolean/patch_ring.h"

namespace glint {

/// kDone when the new surface fits its border, is closed otherwise, and has neither faces without
/// area nor faces that cross each other or faces nearby.
ImprintOutcome check_surface(const NewSurface& surface,
                             const Patch& patch,
                             const ImprintedMeshState& part);

}  // namespace glint
