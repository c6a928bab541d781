// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sight lines from the part to the camera, and where the tunnel's wall stands in their way.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "simulator/light/tunnel/tunnel.h"

namespace glint {

/// Where sight lines cross the wall, for points that stand for their neighbourhood.
struct SightLines {
  /// 1 where the wall hides the point from the camera (sight line through the wall and not through
  /// the slot), else 0.
  std::vector<float> occluded;
  std::vector<float> x_mm, y_mm, z_mm;  ///< of the crossing; kNoHitMargin_mm: none
  /// From the crossing to where `occluded` changes, along x and across it.
  std::vector<float> to_end_mm, to_edge_mm;
};

SightLines sight_lines(const Tunnel& tunnel,
                       const RayBlock& points,
                       const Eigen::Vector3d& camera_mm);

}  // namespace glint
