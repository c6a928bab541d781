// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/scene_picture.h"

#include "studies/imaging/mirror_picture.h"
#include "studies/imaging/path_scene_picture.h"

namespace glint {

std::optional<SlotMargin> ScenePicture::find_slot_margin() const {
  if (!scene_.has_tunnel) {
    return std::nullopt;
  }
  return slot_margin(
      traced_->seen(), traced_->region.mask, Tunnel(scene_.tunnel), traced_->camera_in_world_mm);
}

std::unique_ptr<ScenePicture> picture_of(SceneStore& store,
                                         const SceneSettings& scene,
                                         const PictureRequest& request) {
  return needs_paths(scene) ? path_scene_picture(store, first_view(store, scene), request)
                            : mirror_picture(store, scene, request);
}

}  // namespace glint
