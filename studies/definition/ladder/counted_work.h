// SPDX-License-Identifier: GPL-3.0-or-later
//
// What rendering a scene takes, counted from its settings with constants of the source: the same on
// every machine.
#pragma once

#include "studies/definition/scene.h"

namespace glint {

/// Whether light may go from one place of the part to another one, which shades it, too: gears,
/// strips that are hollow along either axis, and meshes, of whose shape nothing is known here.
bool may_see_itself(const SceneSettings& scene);

/// What one evaluation takes, in millions of camera paths with direct light.
double counted_work(const SceneSettings& scene);

/// How many times as much a finalist takes when it is re-scored by rescoring_settings().
double rescoring_factor(const SceneSettings& scene);

}  // namespace glint
