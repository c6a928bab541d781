// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/blurred/kept_ray_scan.h"

#include "core/error.h"
#include "simulator/material/material_settings.h"
#include "simulator/render/blurred/blurred_scan.h"
#include "simulator/render/path_tracing/packet_numbers.h"
#include "studies/definition/render_methods.h"

namespace glint {
namespace {

ConductorNumbers metal_of(const SceneSettings& scene) {
  const SurfaceMaterial material(scene.material, scene.sensor.wavelengths_nm);
  const auto metal = conductor_numbers(material.plain());
  GLINT_CHECK(metal.has_value(), "rough metal");
  return *metal;
}

}  // namespace

KeptRayScan::KeptRayScan(const SceneSettings& scene, ThreadPool& pool)
    : tunnel_(scene.tunnel), settings_(scene.scan), pool_(pool) {
  if (is_blurred(scene)) {
    metal_ = metal_of(scene);
  }
}

ScanResult KeptRayScan::scan(const RayCache& rays,
                             const Sensor& sensor,
                             const Eigen::Vector3d& camera_in_world_mm,
                             const FrameConsumer& consume) const {
  if (!metal_) {
    return take_scan(rays, tunnel_, sensor, settings_, camera_in_world_mm, consume);
  }
  const BlurredPixels pixels =
      blurred_pixels(rays, tunnel_, *metal_, settings_, camera_in_world_mm, &pool_);
  return take_blurred_scan(pixels, tunnel_.settings(), sensor, settings_, consume);
}

}  // namespace glint
