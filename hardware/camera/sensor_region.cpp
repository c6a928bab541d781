// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/sensor_region.h"

namespace glint::aravis {
namespace {

void check_region(const SensorRegion& region, const SensorRegion& sensor) {
  if (region.x_px < 0 || region.y_px < 0 || region.width_px < 1 || region.height_px < 1 ||
      region.x_px + region.width_px > sensor.width_px ||
      region.y_px + region.height_px > sensor.height_px) {
    throw ConfigError(
        "region_px",
        fmt::format("{} x {} pixels from ({}, {}) do not lie on the sensor of {} x {}",
                    region.width_px,
                    region.height_px,
                    region.x_px,
                    region.y_px,
                    sensor.width_px,
                    sensor.height_px));
  }
}

}  // namespace

void set_region(ArvCamera* camera, const std::optional<SensorRegion>& wanted) {
  SensorRegion whole;
  gint smallest = 0;
  Failure failure;
  arv_camera_set_region(camera, 0, 0, 0, 0, failure.slot());  // offsets alone: they limit the sides
  failure.check("region_px");
  arv_camera_get_width_bounds(camera, &smallest, &whole.width_px, failure.slot());
  failure.check("region_px");
  arv_camera_get_height_bounds(camera, &smallest, &whole.height_px, failure.slot());
  failure.check("region_px");
  const SensorRegion region = wanted.value_or(whole);
  check_region(region, whole);
  arv_camera_set_region(
      camera, region.x_px, region.y_px, region.width_px, region.height_px, failure.slot());
  failure.check("region_px");
  SensorRegion set;
  arv_camera_get_region(
      camera, &set.x_px, &set.y_px, &set.width_px, &set.height_px, failure.slot());
  failure.check("region_px");
  if (set != region) {
    throw ConfigError("region_px",
                      fmt::format("this camera makes of it {} x {} pixels from ({}, {})",
                                  set.width_px,
                                  set.height_px,
                                  set.x_px,
                                  set.y_px));
  }
}

}  // namespace glint::aravis
