// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/larger_pixels.h"

#include <algorithm>

namespace glint {

SceneSettings with_larger_pixels(SceneSettings scene, int factor) {
  CameraSettings& camera = scene.camera;
  const PinholeIntrinsics full = intrinsics_of(camera);
  if (factor == 1) {
    return scene;
  }
  camera.width_px = std::max(1, camera.width_px / factor);
  camera.height_px = std::max(1, camera.height_px / factor);
  camera.center_x_px = full.center_px.x() / factor;
  camera.center_y_px = full.center_px.y() / factor;
  camera.pixel_mm *= factor;
  camera.object_pixel_mm *= factor;
  camera.focal_x_px /= factor;
  camera.focal_y_px /= factor;
  scene.sensor.blur_px /= factor;
  scene.metrics.erosion_px = (scene.metrics.erosion_px + factor - 1) / factor;
  return scene;
}

}  // namespace glint
