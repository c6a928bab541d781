// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/scene_picture.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "simulator/sensor/sensor.h"
#include "studies/definition/render_methods.h"
#include "studies/imaging/mirror_picture.h"
#include "studies/imaging/path_scene_picture.h"

namespace glint {
namespace {

/// So small that no radiance below 1e6 clips.
constexpr double kProbeExposure = 1e-6;

/// A sensor that measures radiance: blurred as the picture will be, without anything else.
SensorSettings probe_of(const SensorSettings& settings) {
  SensorSettings probe = without_noise(settings);
  probe.exposure = kProbeExposure;
  probe.gain = 1.0;
  probe.bits = 0;
  return probe;
}

/// picture_of() a scene that is exposed. @param film_sensor  as of path_scene_picture()
std::unique_ptr<ScenePicture> exposed_picture(SceneStore& store,
                                              const SceneSettings& scene,
                                              const PictureRequest& request,
                                              const SensorSettings* film_sensor = nullptr) {
  return needs_paths(scene)
             ? path_scene_picture(store, first_view(store, scene), request, film_sensor)
             : mirror_picture(store, scene, request);
}

/// The grey values of the region of interest in all frames.
std::vector<float> grey_of_region(SceneStore& store,
                                  const SceneSettings& scene,
                                  const SensorSettings& film_sensor) {
  const auto picture = exposed_picture(store, scene, {.has_flawless = false}, &film_sensor);
  const Mask& region = picture->traced()->region.mask;
  std::vector<float> values;
  const auto watch = [&](int /*index*/, const ImageF& grey) {
    for (std::size_t i = 0; i < region.size(); ++i) {
      if (region.values()[i] != 0) {
        values.push_back(grey.values()[i]);
      }
    }
  };
  picture->mean({.watch = watch, .has_whole_frames = true});
  return values;
}

/// The value that 99 of 100 do not exceed; 0 for none. @param values  are reordered
double brightest_percent(std::vector<float>& values) {
  constexpr double kShare = 0.99;
  if (values.empty()) {
    return 0.0;
  }
  const auto count = static_cast<double>(values.size());
  const auto rank = static_cast<std::ptrdiff_t>(std::max(0.0, std::ceil(kShare * count) - 1.0));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return static_cast<double>(values[static_cast<std::size_t>(rank)]);
}

/// The sensor that light is summed for while the exposure is looked for: with about the exposure
/// that will be found, so that the picture is summed once and serves for both. Where nothing tells
/// it, or nothing is summed, the probe itself.
SensorSettings film_sensor_of(SceneStore& store,
                              const SceneSettings& scene,
                              const SensorSettings& probe,
                              double wanted) {
  if (!is_direct(scene)) {
    return probe;
  }
  std::vector<float> radiance = coarse_radiance(store, first_view(store, scene));
  const double bright = brightest_percent(radiance);
  if (bright <= 0.0 || wanted <= 0.0) {
    return probe;
  }
  SensorSettings sensor = scene.sensor;
  sensor.exposure = wanted / (bright * scene.sensor.gain);
  return sensor;
}

}  // namespace

SceneSettings with_equal_exposure(SceneStore& store, SceneSettings scene) {
  if (scene.expose_to <= 0.0) {
    return scene;
  }
  SceneSettings probed = scene;
  probed.expose_to = 0.0;
  probed.sensor = probe_of(scene.sensor);
  const double wanted = scene.expose_to - dark_grey(scene.sensor);
  std::vector<float> values =
      grey_of_region(store, probed, film_sensor_of(store, scene, probed.sensor, wanted));
  const double bright = brightest_percent(values);
  if (bright <= 0.0 || wanted <= 0.0) {
    throw ConfigError("sensor.expose_to",
                      bright <= 0.0 ? "cannot be reached: no light comes from the flawless region"
                                    : "is not above the sensor's dark signal");
  }
  scene.sensor.exposure = wanted * kProbeExposure / (bright * scene.sensor.gain);
  scene.expose_to = 0.0;
  return scene;
}

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
  if (scene.expose_to > 0.0) {
    return picture_of(store, with_equal_exposure(store, scene), request);
  }
  return exposed_picture(store, scene, request);
}

}  // namespace glint
