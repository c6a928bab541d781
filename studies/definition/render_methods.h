// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a scene's method of rendering means for those who do not render: how its frames come about,
// what a closer look at it is, and which methods it can be compared by. The keys of [render].
#pragma once

#include <cstddef>
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
  std::string name;  ///< "paths", "sampled", "blurred" or "integrated"
  std::vector<std::pair<std::string, int>> numbers;  ///< that are told with it
  bool has_closed_mean = false;  ///< a search may take their mean from closed forms instead
};

FrameMethod frame_method(const SceneSettings& scene);

/// Whether render.method asks for blurred reflections.
bool is_blurred(const SceneSettings& scene);

/// What of the scene blurred reflections do not model, whatever render.method is: each with its key
/// and without a place; none: they may render it, if the light of its part never meets the part
/// again (studies/imaging/blurred).
std::vector<Problem> blurred_problems(const SceneSettings& scene);

/// The scene for re-scoring a finalist: other noise, every frame, and finer rays.
SceneSettings finer_settings(SceneSettings scene);

/// The scene for looking where things lie in the picture: a ray a pixel, but for path tracing.
SceneSettings coarse_settings(SceneSettings scene);

/// The scene with noise of its own and nothing else changed: scan number `index` of a design that
/// is scored repeatedly. Scenes that differ in their lighting share the noise of a number.
SceneSettings repeated_settings(SceneSettings scene, int index);

/// A method of rendering with one accuracy.
struct ComparedMethod {
  std::size_t kind = 0;         ///< 0 to 5: which method, whatever its accuracy
  std::string kind_name;        ///< "plain sampling", "integrated", "closed forms", "own choice",
                                ///< "paths", "blurred"
  std::string label;            ///< unique; "4 rays a pixel", "integrated, 0.2 mrad", "64 samples"
  RenderSettings render;        ///< of a scene that is rendered so
  PathSettings paths;           ///< the same, where paths are followed
  int rays_per_px = 0;          ///< 0: as many as the method needs
  double direction_mrad = 0.0;  ///< max_direction_error_mrad; 0: has no meaning
  bool has_frames = true;       ///< false: scores alone are asked for, as in a search
  bool is_usual = false;        ///< the accuracy of its kind with which other things are varied
  bool is_choice = false;       ///< what the program does by itself
  bool follows_paths = false;   ///< its pictures have noise of their own
  bool is_current = false;      ///< with the accuracy that the scene has now
};

/// The methods that a mirror under a tunnel can be rendered by, by kind, each from coarse to fine;
/// none for a scene of rough metal, or that only path tracing knows.
std::vector<ComparedMethod> compared_methods(const SceneSettings& scene);

/// Path tracing from coarse to fine: 1, 4, 16, 64, 256, 1024 samples a pixel and the scene's own
/// number with its own reflections, then its own number of samples with 1, 2, 4 reflections and
/// twice its own; last blurred reflections of 1, 4, 16 rays, where they may render the scene. None
/// for a mirror under a tunnel that nothing asks paths of.
std::vector<ComparedMethod> compared_paths(const SceneSettings& scene);

/// The scene rendered by a method.
SceneSettings rendered_by(const ComparedMethod& method, SceneSettings scene);

/// The scene by path tracing with a number of samples and other random numbers: picture `index` of
/// several that share nothing.
SceneSettings independent_paths(SceneSettings scene, int samples, int index);

}  // namespace glint
