// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether pictures that are there are of the lights that a scene has.
#pragma once

#include <filesystem>
#include <string>

#include "studies/definition/scene.h"

namespace glint {

/// The first light that two scenes have built differently, or let shine at different powers, as
/// "[lighting.ring] is built differently". The place of the stripes does not count.
/// @return empty: they have the same lights
std::string light_difference(const SceneSettings& one, const SceneSettings& other);

/// The same of the scene.toml in a folder of acquired pictures.
/// @throws ConfigError, IoError where it cannot be read
std::string light_difference(const std::filesystem::path& acquired, const SceneSettings& wanted);

}  // namespace glint
