// SPDX-License-Identifier: GPL-3.0-or-later
//
// The table [lighting] of a scene: a table for each light, one of which may be the fringe tunnel.
#pragma once

#include <string>
#include <vector>

#include "studies/definition/scene.h"

namespace glint {

/// Reads which lights shine: "all", or names of tables below [lighting] with + between them.
/// @param name    of the key in root
/// @param errors  grows by the problems found
void read_lighting_use(const ConfigNode& root,
                       const std::string& name,
                       SceneSettings& scene,
                       std::vector<Problem>& errors);

/// Its row of the key table.
KeyRow lighting_use_key();

/// Reads the lights into the scene in place of its own; without the table it has one plain tunnel.
/// Lights that scene.lighting_use leaves out are checked and kept apart, so that they are neither
/// built nor decide how pictures come about.
/// @param name    of the table in root
/// @param errors  grows by the problems found
void read_lighting(const ConfigNode& root,
                   const std::string& name,
                   SceneSettings& scene,
                   std::vector<Problem>& errors);

ConfigNode write_lighting(const SceneSettings& scene);

}  // namespace glint
