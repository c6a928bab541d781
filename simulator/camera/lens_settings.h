// SPDX-License-Identifier: GPL-3.0-or-later
//
// The [lens] table: what a data sheet and a focus ring say beyond [camera]. With it, focal length,
// image distance, object pixel, field of view and depth of field all follow from one another.
#pragma once

#include <Eigen/Core>

#include "core/config/keys.h"
#include "simulator/camera/camera_settings.h"

namespace glint {

/// Keys of the lens. The defaults are a pinhole, and [camera] means what it means without them.
struct LensSettings {
  double focus_mm = 0.0;  ///< from the lens to the plane in focus; 0: infinity
  double f_number = 0.0;  ///< focal length over diameter of the entrance pupil; 0: a pinhole
};

void visit_keys(KeyVisitor& keys, LensSettings& settings);

/// Everything about a camera that follows from its settings, in mm.
struct LensGeometry {
  double focal_mm = 0.0;                          ///< of the thin lens
  double image_distance_mm = 0.0;                 ///< from the lens to the sensor
  double focus_mm = 0.0;                          ///< may be infinite
  double aperture_mm = 0.0;                       ///< diameter of the pupil, 0: a pinhole
  double object_pixel_mm = 0.0;                   ///< a pixel at the working distance
  Eigen::Vector2d sensor_mm = {0.0, 0.0};         ///< width and height of the sensor
  Eigen::Vector2d field_of_view_mm = {0.0, 0.0};  ///< at the working distance, without distortion
  Eigen::Vector2d view_angle_rad = {0.0, 0.0};    ///< full angles across width and height
  double near_mm = 0.0;  ///< nearest distance whose blur is at most one pixel wide
  double far_mm = 0.0;   ///< farthest such distance, may be infinite
};

/// The geometry two tables describe. The sensor stands where the plane in focus is sharp: with
/// 1 / focal = 1 / focus + 1 / image distance. Given focal_mm the image distance follows; given
/// object_pixel_mm or a calibration the image distance is given and focal_mm follows.
/// @throws ConfigError when the focus is not beyond the focal length
LensGeometry lens_geometry(const CameraSettings& camera, const LensSettings& lens);

/// As intrinsics_of(camera), with the image distance of a lens that is focused at lens.focus_mm.
/// @throws ConfigError as lens_geometry()
PinholeIntrinsics intrinsics_of(const CameraSettings& camera, const LensSettings& lens);

}  // namespace glint
