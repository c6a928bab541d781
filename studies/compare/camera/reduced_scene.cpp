// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/camera/reduced_scene.h"

#include <algorithm>

#include "core/image/spans.h"
#include "simulator/sensor/sensor.h"
#include "studies/compare/camera/scene_camera.h"

namespace glint {

SceneSettings reduced_scene(const SceneSettings& scene, int factor, int min_samples) {
  SceneSettings small = scene;
  PinholeIntrinsics in = intrinsics_of(scene);
  in.focal_px /= factor;
  in.center_px /= factor;
  put_intrinsics(in, small);
  small.camera.width_px /= factor;
  small.camera.height_px /= factor;
  small.camera.pixel_mm *= factor;
  small.sensor = without_noise(scene.sensor);
  small.sensor.bits = 0;
  small.sensor.blur_px /= factor;
  small.paths.samples = std::max(scene.paths.samples, min_samples);
  small.paths.batches = 2;
  small.paths.relative_error = 0.0;  // all pixels have as many samples
  return small;
}

Mask sound_part(const Film& sums, int margin_px) {
  Mask other(sums.width_px, sums.height_px);
  for (std::size_t i = 0; i < other.size(); ++i) {
    const std::int32_t samples = sums.samples.values()[i];
    const bool is_whole = samples > 0 && sums.part.values()[i] == samples;
    const bool is_sound = std::ranges::all_of(
        sums.defects, [&](const DefectSums& defect) { return defect.samples.values()[i] == 0; });
    other.values()[i] = is_whole && is_sound ? 0 : 1;
  }
  Mask sound = dilated(other, margin_px);
  std::ranges::transform(sound.values(), sound.values().begin(), [](unsigned char value) {
    return static_cast<unsigned char>(value == 0 ? 1 : 0);
  });
  return sound;
}

}  // namespace glint
