// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/searched/searched_scene.h"

#include "studies/definition/render_methods.h"
#include "studies/imaging/direct/hidden_lights.h"
#include "studies/imaging/path_picture.h"

namespace glint {
namespace {

/// Of the part with its defects and without them, as both are rendered.
/// @param scene  path-traced
bool may_hide_lamps(SceneStore& store, const SceneSettings& scene) {
  const SceneSettings first = first_view(store, scene);
  const auto part = store.build_defects(first);
  const auto is_hidden = [&](bool has_defects) {
    const PathView view(first, part, first.viewpoint(), has_defects);
    return hidden_lights_problem(view.physical()).has_value();
  };
  return is_hidden(true) || (part->built != part->clean && is_hidden(false));
}

}  // namespace

SceneSettings searched_scene(SceneStore& store,
                             const SceneSettings& scene,
                             const RenderRung& rung) {
  SceneSettings searched = at_rung(scene, rung);
  if (is_direct(scene) || !is_direct(searched)) {
    return searched;
  }
  SceneSettings by_paths = scene;
  by_paths.paths.samples = rung.paths.samples;
  by_paths.paths.max_reflections = rung.paths.max_reflections;
  return may_hide_lamps(store, by_paths) ? by_paths : searched;
}

}  // namespace glint
