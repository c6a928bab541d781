// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small inspection line for tests of its scores.
#pragma once

#include "studies/definition/scene.h"

namespace glint {

/// A polished strip under a semicylinder with three random dents; no slot. Stripes through which
/// the dents are found with a probability that is neither 0 nor 1.
inline SceneSettings small_line(double low_um, double high_um) {
  SceneSettings scene;
  scene.part.length_mm = 36.0;
  scene.part.width_mm = 20.0;
  scene.part.radius_along_mm = 400.0;
  scene.part.radius_across_mm = 60.0;
  scene.camera.width_px = 200;
  scene.camera.height_px = 100;
  scene.camera.object_pixel_mm = 0.15;
  scene.camera.working_distance_mm = 400.0;
  scene.viewpoint() = default_viewpoint(scene.camera);
  scene.sensor.gain = 1.5;
  scene.sensor.blur_px = 1.0;
  scene.sensor.full_well_e = 20000.0;
  scene.sensor.read_noise_e = 8.0;
  scene.tunnel.radius_mm = 150.0;
  scene.tunnel.slot_mm = 0.0;
  scene.tunnel.blocks_view = false;
  scene.tunnel.length_mm = 1200.0;
  DefectGroup dents;
  dents.count = 3;
  dents.height_mm = Interval(1e-3 * low_um, 1e-3 * high_um);
  dents.diameter_mm = Interval(0.6, 1.0);
  dents.region.kind = DefectRegion::Kind::kBox;
  dents.region.min_mm = {-10.0, -5.0, -10.0};
  dents.region.max_mm = {10.0, 5.0, 20.0};
  dents.region.facing_rad = 1.0;
  scene.defects = {{"dent", dents}};
  scene.inspection.threshold = InspectionSettings::Threshold::kFalseAlarms;
  scene.inspection.trials.parts = 6;
  scene.inspection.trials.flawless = 8;
  return scene;
}

}  // namespace glint
