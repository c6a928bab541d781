// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the reference tracer knows of a scene: one convex part under an extruded tunnel wall with
// straight stripes and a slot, a thin-lens camera, a linear sensor. Plain numbers in double;
// nothing of the renderer is used. Scenes with more than that are refused by the key at fault.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "studies/definition/scene.h"

namespace glint::stability {

/// A round dent (height < 0) or bump with a Gaussian profile, along the part's z.
struct ReferenceDent {
  std::string label;
  double x_mm = 0.0;  ///< part frame before its centring, as in the scene file
  double y_mm = 0.0;
  double height_mm = 0.0;
  double sigma_mm = 1.0;  ///< > 0; the defect's radius is 2 sigma
};

struct ReferencePart {
  enum class Shape { kParaboloid, kSphere, kCylinder };

  Shape shape = Shape::kParaboloid;
  double bend_along = 0.0;               ///< paraboloid: 1 / radius [1 / mm], >= 0
  double bend_across = 0.0;              ///< likewise in the y-z plane
  double radius_mm = 1.0;                ///< sphere, cylinder around x
  double centre_z_mm = 0.0;              ///< apex of the paraboloid; centre of sphere and cylinder
  Eigen::Vector2d half_mm = {1.0, 1.0};  ///< paraboloid, cylinder (x only): half its size
  double base_z_mm = 0.0;                ///< sphere: only what lies above
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  std::vector<ReferenceDent> dents;
};

struct ReferenceCamera {
  int width_px = 0;
  int height_px = 0;
  Eigen::Vector2d focal_px = {1.0, 1.0};
  Eigen::Vector2d center_px = {0.0, 0.0};
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 3> axes;  ///< right, down, forward in the scene
  double aperture_mm = 0.0;             ///< diameter, 0: a pinhole
  double focus_mm = 0.0;                ///< of the plane in focus, with an aperture
};

/// The wall is the upper half of an ellipse in the y-z plane, extruded along x.
struct ReferenceWall {
  double half_width_mm = 1.0;
  double height_mm = 1.0;
  double base_mm = 0.0;
  double length_mm = 1.0;
  double slot_mm = 0.0;
  bool blocks_view = true;
  double period_mm = 1.0;
  double duty = 0.5;
  double offset_mm = 0.0;
  double step_mm = 0.0;
  int positions = 1;
};

struct ReferenceScene {
  ReferencePart part;
  ReferenceCamera camera;
  ReferenceWall wall;
  SensorSettings sensor;  ///< read_noise_e = dark_e = 0
  MetricsSettings metrics;
  /// Of each dent, the pixels that its change is the mean over, row by row; empty: by radii_from().
  std::vector<std::vector<std::size_t>> dent_pixels = {};
};

/// @throws ConfigError naming the key of what the reference does not model
ReferenceScene reference_scene(const SceneSettings& scene);

}  // namespace glint::stability
