// SPDX-License-Identifier: GPL-3.0-or-later
//
// The methods of rendering that a scene can be compared by, each with several accuracies.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "studies/definition/scene.h"

namespace glint {

/// A method of rendering with one accuracy.
struct ComparedMethod {
  std::size_t kind = 0;         ///< 0 to 6: which method, whatever its accuracy
  std::string kind_name;        ///< "plain sampling", "integrated", "closed forms", "own choice",
                                ///< "paths", "blurred", "direct sum"
  std::string label;            ///< unique; "4 rays a pixel", "integrated, 0.2 mrad", "64 samples"
  RenderSettings render;        ///< of a scene that is rendered so
  PathSettings paths;           ///< the same, where paths are followed
  int rays_per_px = 0;          ///< 0: as many as the method needs
  double direction_mrad = 0.0;  ///< max_direction_error_mrad; 0: has no meaning
  bool has_frames = true;       ///< false: scores alone are asked for, as in a search
  bool is_usual = false;        ///< the accuracy of its kind with which other things are varied
  bool is_choice = false;       ///< what the program does by itself
  bool is_noisy = false;        ///< its pictures have noise of their own
  bool has_film = false;        ///< its pictures are of SceneStore::picture()
  bool is_current = false;      ///< with the accuracy that the scene has now
};

/// The methods that a mirror under a tunnel can be rendered by, by kind, each from coarse to fine;
/// none for a scene of rough metal, or that only path tracing knows.
std::vector<ComparedMethod> compared_methods(const SceneSettings& scene);

/// Path tracing from coarse to fine: 1, 4, 16, 64, 256, 1024 samples a pixel and the scene's own
/// number with its own reflections, then its own number of samples with 1, 2, 4 reflections and
/// twice its own; last blurred reflections or the sum of direct light of 1, 4, 16 rays, where they
/// may render the scene. None for a mirror under a tunnel that nothing asks paths of.
std::vector<ComparedMethod> compared_paths(const SceneSettings& scene);

/// Whether pictures without noise are the scene's reference, those of compared_methods(); else it
/// is the mean of many followed paths, and compared_paths() are held against it.
bool has_noiseless_reference(const SceneSettings& scene);

/// The scene rendered by a method.
SceneSettings rendered_by(const ComparedMethod& method, SceneSettings scene);

/// The scene by path tracing with a number of samples and other random numbers: picture `index` of
/// several that share nothing.
SceneSettings independent_paths(SceneSettings scene, int samples, int index);

}  // namespace glint
