// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the settings of a scene cannot tell of a rung, and its built lamps and part can.
#pragma once

#include <map>
#include <span>
#include <string>

#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// A design's scene as a search renders it at a rung: at_rung(), but by paths with the rung's own
/// samples where a sum of direct light would be refused, as a lamp may hide another one or parts of
/// itself from the part (hidden_lights_problem()). A scene that asks for render.method = "direct"
/// itself stays as it is. Half resolution that leaves a defect no pixel or no background, or the
/// part no region, gives way to all pixels with as many samples as the rung has, or the scene
/// itself where it has more. So it does where a score of a simulated line is asked for and the
/// inspector's rim leaves nothing of the part.
/// @param trials  scores of WantedScores::trials
/// @throws ConfigError beginning with the key at fault when part or lamps cannot be built, IoError
SceneSettings searched_scene(SceneStore& store,
                             const SceneSettings& scene,
                             const RenderRung& rung,
                             std::span<const std::string> trials);

/// less_offsets(), where searched_scene() has the rung's larger pixels.
/// @param searched  searched_scene() of the scene
void less_offsets(const SceneSettings& scene,
                  const SceneSettings& searched,
                  const RenderRung& rung,
                  std::map<std::string, double>& scores);

}  // namespace glint
