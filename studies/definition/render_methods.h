// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a scene's method of rendering means for those who do not render: how its frames come about,
// what a closer look at it is, and which scenes a method does not model. The keys of [render].
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "studies/definition/scene.h"

namespace glint {

/// [render] and what it holds.
struct RenderTable {
  RenderSettings render;
  PathSettings paths;
};

void visit_keys(KeyVisitor& keys, RenderTable& table);

/// How the frames of a scene come about, as scores.json tells it.
struct FrameMethod {
  std::string name;  ///< "paths", "direct", "sampled", "blurred" or "integrated"
  std::vector<std::pair<std::string, int>> numbers;  ///< that are told with it
  bool has_closed_mean = false;  ///< a search may take their mean from closed forms instead
  bool is_noisy = false;         ///< drawn paths: pixels differ with the seed
};

FrameMethod frame_method(const SceneSettings& scene);

/// Whether render.method asks for blurred reflections.
bool is_blurred(const SceneSettings& scene);

/// The scene as its material has it rendered where blurred reflections are asked for: rough metal
/// by paths, a mirror by its rays. For those who look at single places of the part.
SceneSettings without_blurred_method(SceneSettings scene);

/// What of the scene blurred reflections do not model, whatever render.method is: each with its key
/// and without a place; none: they may render it, if the light of its part never meets the part
/// again (studies/imaging/blurred).
std::vector<Problem> blurred_problems(const SceneSettings& scene);

/// Whether render.method asks for the sum of direct light.
bool is_direct(const SceneSettings& scene);

/// What of the scene the sum of direct light does not model, whatever render.method is: each with
/// its key and without a place; none: it may render the scene, with max_reflections = 1.
std::vector<Problem> direct_problems(const SceneSettings& scene);

/// Whether the picture that light followed over the part gives (SceneStore::picture()) shows how
/// rough its material is; there is none of a mirror under a tunnel.
bool shows_roughness(const SceneSettings& scene);

/// The scene for re-scoring a finalist: other noise, every frame, and finer rays.
SceneSettings rescoring_settings(SceneSettings scene);

/// The scene for looking where things lie in the picture: a ray a pixel, but for path tracing.
SceneSettings coarse_settings(SceneSettings scene);

/// The scene with noise of its own and nothing else changed: scan number `index` of a design that
/// is scored repeatedly. Scenes that differ in their lighting share the noise of a number.
SceneSettings repeated_settings(SceneSettings scene, int index);

/// "2 reflections", "1 reflection": those that are followed.
std::string reflections_text(const PathSettings& paths);

/// How pictures and scores of the scene's designs come about, as a report tells it once for all.
std::vector<std::string> method_notes(const SceneSettings& scene);

}  // namespace glint
