// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/larger_pixels.h"

#include <algorithm>

namespace glint {
namespace {

/// Of a limit on a whole number: what is at least the limit before is at least this one after.
int rounded_up(int value, int divisor) {
  return (value + divisor - 1) / divisor;
}

/// Sizes of a class of defects are areas, or areas times grey values.
void enlarge(GradeLimits& limits, int factor) {
  const double area = static_cast<double>(factor) * factor;
  limits.perfect_biggest /= area;
  limits.perfect_sum /= area;
  limits.acceptable_biggest /= area;
  limits.acceptable_sum /= area;
}

/// The Gaussian keeps its sigma on the part, also where that follows from the kernel's width.
void enlarge_filters(InspectionSettings& inspection, int factor) {
  constexpr double kMinTemplate_px = 1.0;
  constexpr double kMinStructure_px = 2.0;
  constexpr double kMinScale_px = 0.3;
  const int half = (inspection.kernel_px - 1) / 2;
  const double sigma_px =
      inspection.sigma_px > 0.0 ? inspection.sigma_px : 0.3 * (half - 1.0) + 0.8;
  inspection.sigma_px = sigma_px / factor;
  inspection.kernel_px = 2 * std::max(1, rounded_up(half, factor)) + 1;
  for (double& scale_px : inspection.scales_px) {
    scale_px = std::max(kMinScale_px, scale_px / factor);
  }
  inspection.template_px = std::max(kMinTemplate_px, inspection.template_px / factor);
  inspection.structure_px = std::max(kMinStructure_px, inspection.structure_px / factor);
}

void enlarge(InspectionSettings& inspection, int factor) {
  enlarge_filters(inspection, factor);
  inspection.erosion_px = rounded_up(inspection.erosion_px, factor);
  inspection.min_area_px = rounded_up(inspection.min_area_px, factor * factor);
  inspection.hole_below_px = rounded_up(inspection.hole_below_px, factor * factor);
  inspection.trials.echo_px /= factor;
  enlarge(inspection.holes, factor);
  enlarge(inspection.scratches, factor);
}

void enlarge(CoverageSettings& coverage, int factor) {
  coverage.max_pixel_mm *= factor;
  coverage.max_blur_px /= factor;
  coverage.defect_px /= factor;
}

}  // namespace

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
  scene.metrics.erosion_px = rounded_up(scene.metrics.erosion_px, factor);
  scene.metrics.defect_diameter_px /= factor;
  enlarge(scene.inspection, factor);
  enlarge(scene.coverage, factor);
  return scene;
}

}  // namespace glint
