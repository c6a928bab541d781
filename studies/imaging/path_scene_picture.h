// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any part under any lights, by path tracing: one frame under area lights alone, as many as
// scan.positions under a tunnel.
#pragma once

#include <memory>
#include <vector>

#include "studies/imaging/scene_picture.h"

namespace glint {

/// picture_of() a scene with needs_paths().
/// @param scene        from the viewpoint that is scored
/// @param film_sensor  that a sum of direct light is made exact for, see brightness_octave();
///                     nullptr: the scene's own
std::unique_ptr<ScenePicture> path_scene_picture(SceneStore& store,
                                                 const SceneSettings& scene,
                                                 const PictureRequest& request,
                                                 const SensorSettings* film_sensor = nullptr);

/// Radiance of pixels of the region of interest in all frames, before blur: light is summed
/// coarsely for a ninth of the picture's pixels, in tiles spread over it, and nothing of it is
/// kept. Empty where no light is summed, or none of these pixels is of the region.
/// @param scene  from the viewpoint that is scored
/// @throws ConfigError beginning with the key at fault, IoError
std::vector<float> coarse_radiance(SceneStore& store, const SceneSettings& scene);

}  // namespace glint
