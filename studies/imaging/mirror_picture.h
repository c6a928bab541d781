// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part under a tunnel, along rays that are traced once: of a mirror by samples, by footprints or
// by closed forms, of rough metal by blurred reflections, as render.method says.
#pragma once

#include <memory>

#include "studies/imaging/scene_picture.h"

namespace glint {

/// picture_of() a scene without needs_paths().
std::unique_ptr<ScenePicture> mirror_picture(SceneStore& store,
                                             const SceneSettings& scene,
                                             const PictureRequest& request);

}  // namespace glint
