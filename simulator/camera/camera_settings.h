// SPDX-License-Identifier: GPL-3.0-or-later
//
// The [camera] and [[viewpoint]] tables: a camera by data sheet (pixel size, focal length, working
// distance) or by calibration (focal lengths and principal point in px), and where it stands.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/config/keys.h"
#include "core/config/pose_keys.h"
#include "core/pose.h"
#include "simulator/camera/pinhole_camera.h"

namespace glint {

/// Keys of [camera].
struct CameraSettings {
  int width_px = 1300;
  int height_px = 300;
  double pixel_mm = 0.0055;            ///< size of a pixel on the sensor
  double focal_mm = 0.0;               ///< 0: from object_pixel_mm and the working distance
  double object_pixel_mm = 0.15;       ///< size of a pixel on the part; 0: from focal_mm
  double working_distance_mm = 600.0;  ///< from the pinhole to the scene's origin
  double focal_x_px = 0.0;             ///< calibrated; 0: from the data sheet
  double focal_y_px = 0.0;             ///< calibrated; 0: equal to focal_x_px
  double center_x_px = 0.0;            ///< principal point; 0: the middle
  double center_y_px = 0.0;
  double k1 = 0.0, k2 = 0.0, k3 = 0.0, p1 = 0.0, p2 = 0.0;
};

/// One entry of [[viewpoint]]: nine numbers.
struct Viewpoint {
  std::vector<double> position_mm = {0.0, 0.0, 600.0};
  std::vector<double> direction = {0.0, 0.0, -1.0};  ///< of the view, any length
  std::vector<double> up = {0.0, 1.0, 0.0};          ///< towards the top of the image
  /// What the nine numbers were made of, when a file gives a robot's pose instead; no key by
  /// itself.
  std::optional<PoseSettings> base_from_flange = {};
};

void visit_keys(KeyVisitor& keys, CameraSettings& settings);
void visit_keys(KeyVisitor& keys, Viewpoint& viewpoint);

/// The intrinsics a settings table describes.
PinholeIntrinsics intrinsics_of(const CameraSettings& settings);

/// Straight above the origin at the working distance, image x along world x.
Viewpoint default_viewpoint(const CameraSettings& settings);

/// camera_from_world of a viewpoint. @throws ConfigError when direction and up are parallel or
/// zero.
RigidTransform camera_from_world(const Viewpoint& viewpoint);

}  // namespace glint
