// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "metrics/lighting_scores.h"
#include "studies/definition/scene.h"
#include "studies/imaging/path_lights.h"

namespace glint {

/// Size, LEDs, scan time and cost of the lights that shine, from the settings alone: nothing is
/// rendered, only the mesh of a mesh light is read. A light shines when lighting_use has it and its
/// radiance or power is above 0; its segments are not told apart. Lights on the camera stand where
/// the first viewpoint has them, a tunnel in the middle of its scan.
/// @param load_mesh  reads the mesh of a mesh light
/// @throws ConfigError beginning with the key at fault, IoError
LightingTotals lighting_totals(const SceneSettings& scene,
                               const MeshLoader& load_mesh = load_light_mesh);

}  // namespace glint
