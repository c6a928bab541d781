// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random scenes whose derivatives are looked at, and how their keys are changed a little.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "studies/definition/scene.h"

namespace glint {

/// Strips and a sphere cap, two dents on each; few, so that they are traced once. The first
/// two are larger than the picture: nothing that a derivative holds moves with the camera there.
std::vector<SceneSettings> derivative_parts();

/// Any tunnel that stays away from its own part, stripes and a sensor without noise.
SceneSettings derivative_scene(const std::vector<SceneSettings>& parts, std::uint64_t index);

/// The keys that scores of a scene may be derived by.
std::vector<std::string> keys_offered(const SceneSettings& scene);

/// Of the camera's pose.
bool is_of_pose(const std::string& path);

/// The scene with one number changed, in its written unit.
SceneSettings with_value(const SceneSettings& scene, const std::string& path, double change);

/// The step of a difference, in the key's written unit: the phases of the stripes move by a small
/// part of the ripple that the mean of few frames has.
double step_of(const SceneSettings& scene, const std::string& path);

}  // namespace glint
