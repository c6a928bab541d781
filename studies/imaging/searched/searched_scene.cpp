// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/searched/searched_scene.h"

#include <algorithm>

#include "studies/definition/render_methods.h"
#include "studies/imaging/direct/hidden_lights.h"
#include "studies/imaging/path_picture.h"
#include "studies/inspection_line/simulated_line.h"
#include "studies/inspection_line/visibility.h"

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

/// Whether larger pixels leave each defect a pixel and a background, and the part a region, that of
/// an inspector too where one is asked.
bool can_be_scored(SceneStore& store,
                   const SceneSettings& scene,
                   std::span<const std::string> trials) {
  try {
    store.trace(first_view(store, scene));
    if (std::ranges::any_of(trials, is_of_line)) {
      check_inspected_region(store, scene);
    }
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

bool has_larger_pixels(const SceneSettings& scene, const SceneSettings& own) {
  return scene.camera.width_px != own.camera.width_px;
}

}  // namespace

SceneSettings searched_scene(SceneStore& store,
                             const SceneSettings& scene,
                             const RenderRung& rung,
                             std::span<const std::string> trials) {
  SceneSettings searched = at_rung(scene, rung);
  if (has_larger_pixels(searched, scene) && !can_be_scored(store, searched, trials)) {
    SceneSettings in_all_pixels = scene;
    in_all_pixels.paths.samples = std::max(scene.paths.samples, rung.paths.samples);
    return in_all_pixels;
  }
  if (is_direct(scene) || !is_direct(searched)) {
    return searched;
  }
  SceneSettings by_paths = scene;
  by_paths.paths.samples = rung.paths.samples;
  by_paths.paths.max_reflections = rung.paths.max_reflections;
  return may_hide_lamps(store, by_paths) ? by_paths : searched;
}

void less_offsets(const SceneSettings& scene,
                  const SceneSettings& searched,
                  const RenderRung& rung,
                  std::map<std::string, double>& scores) {
  if (has_larger_pixels(searched, scene)) {
    less_offsets(scene, rung, scores);
  }
}

}  // namespace glint
