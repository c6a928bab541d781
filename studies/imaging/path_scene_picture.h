// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any part under any lights, by path tracing: one frame under area lights alone, as many as
// scan.positions under a tunnel.
#pragma once

#include <memory>

#include "studies/imaging/scene_picture.h"

namespace glint {

/// picture_of() a scene with needs_paths().
/// @param scene  from the viewpoint that is scored
std::unique_ptr<ScenePicture> path_scene_picture(SceneStore& store,
                                                 const SceneSettings& scene,
                                                 const PictureRequest& request);

}  // namespace glint
