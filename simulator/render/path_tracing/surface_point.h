// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "simulator/material/local.h"
#include "simulator/render/path_tracing/physical_scene.h"

namespace glint {

/// Where a ray met the part, and all that its material needs.
struct ShadingPoint {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();  ///< on the exact surface where there is one
  Eigen::Vector3d start_mm = Eigen::Vector3d::Zero();  ///< where rays leave: just off the triangle
  Eigen::Vector3d side = Eigen::Vector3d::UnitZ();     ///< unit, towards the side the ray came from
  ShadingFrame frame;                                  ///< of the detailed normal; scene frame
  LocalDirection to_viewer;
  double reflectance = 1.0;  ///< of stains
  std::int32_t defect = -1;  ///< id, -1: none
};

/// How far off a triangle rays start [mm]: above the rounding of coordinates to float, which is
/// 6e-8 of the largest, and far below anything that is looked at.
double start_offset_mm(const Part& part);

/// Both sides of a triangle reflect, so a part turned inside out looks the same.
ShadingPoint intersect_surface(const PhysicalScene& scene,
                               double start_offset_mm,
                               const Ray& ray,
                               const Hit& hit);

}  // namespace glint
