// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/pose.h"
#include "simulator/light/tunnel/tunnel.h"
#include "simulator/render/ray_cache/ray_cache.h"

namespace glint {

/// How the camera looks through the slot.
struct SlotMargin {
  /// The smallest distance between a sight line to the part and the edge of the slot [mm, across
  /// the tunnel]; negative: the wall hides some of the part. Half the slot's width where nothing
  /// stands in the way.
  double margin_mm = 0.0;
  bool has_sight = false;  ///< a sight line meets the wall or the slot
  Ray sight;          ///< the one with that margin, from the part to the camera, |direction| = way
  double x_mm = 0.0;  ///< where it meets the wall (Tunnel::intersect_block)
  double y_mm = 0.0;
  double wall_margin_mm = 0.0;
};

/// @param region  pixels that must be seen
/// Cost: one sight line for each pixel.
SlotMargin slot_margin(const VisibilityBuffer& seen,
                       const Mask& region,
                       const Tunnel& tunnel,
                       const Eigen::Vector3d& camera_in_world_mm);

}  // namespace glint
