// SPDX-License-Identifier: GPL-3.0-or-later
//
// The table [lighting] of a scene: a table for each light, one of which may be the fringe tunnel.
// [cost]: what it costs and how long its scan takes; no key has a default, what is not given is not
// known.
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

/// The scene with those lights among the others that do not shine, for questions of where lights
/// are. Such a tunnel stands where it does without a scan, and its radiance is even along x.
SceneSettings with_idle_lights(SceneSettings scene);

/// Lights that do not shine are there as well.
/// @throws ConfigError with the key of a light that cannot go along where the flange of a robot
///         holds the scene with its part: one that is fixed in the scene, or a tunnel
void check_lights_go_along(const SceneSettings& scene);

/// Visits the keys of [cost] that have a value.
void visit_keys(KeyVisitor& keys, CostSettings& settings);

/// Reads [cost], of which every key may be absent, into the scene.
/// @param name    of the table in root
/// @param errors  grows by the problems found
void read_cost(const ConfigNode& root,
               const std::string& name,
               SceneSettings& scene,
               std::vector<Problem>& errors);

/// All keys of [cost], for the key table.
std::vector<KeyRow> cost_keys();

}  // namespace glint
