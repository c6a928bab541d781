// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hardware/planning/solid_body.h"
#include "studies/definition/scene.h"

namespace glint {

/// The lights of a scene as bodies: their luminous surfaces, with a thickness. A light that
/// lighting_use leaves out is there, too. Those on the camera are in its frame and of kind
/// kCarried, all others in the scene's frame and of kind kStanding; a tunnel stands where it does
/// at the first position of its scan. Environments and the mirror images of coaxial lights are no
/// bodies.
/// @throws ConfigError, IoError as build_lights()
std::vector<SolidBody> light_bodies(const SceneSettings& scene, double thickness_mm);

}  // namespace glint
