// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sentences about how a scene is lit and rendered, for reports and drawings.
#pragma once

#include <string>
#include <vector>

#include "metrics/scores.h"
#include "studies/definition/scene.h"

namespace glint {

/// One line about each light: "ring, radii 25 to 40 mm, at 30 mm, on the camera", with its name in
/// front where that is not its type.
std::vector<std::string> light_lines(const SceneSettings& scene);

/// How many images the tunnel's scan takes; empty without a tunnel.
std::string scan_line(const SceneSettings& scene);

/// Remarks on a scene that a reader of its numbers must know.
/// @param scores  of the scene
std::vector<std::string> scene_notes(const SceneSettings& scene, const Scores& scores);

/// How pictures and scores of the scene's designs come about, as a report tells it once for all.
std::vector<std::string> method_notes(const SceneSettings& scene);

}  // namespace glint
