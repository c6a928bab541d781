// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/line_camera.h"

#include <utility>

#include "studies/imaging/mirror_line.h"
#include "studies/imaging/path_line.h"

namespace glint {

std::unique_ptr<LineCamera> line_camera_of(SceneStore& store,
                                           const SceneSettings& scene,
                                           std::shared_ptr<const TracedScene> traced) {
  return needs_paths(scene) ? path_line(scene, std::move(traced), store)
                            : mirror_line(scene, std::move(traced), store);
}

}  // namespace glint
