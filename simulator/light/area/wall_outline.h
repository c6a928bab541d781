// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "simulator/light/tunnel/tunnel.h"

namespace glint {

/// A straight piece of a tunnel's cross-section; vectors hold (y, z).
struct WallStrip {
  Eigen::Vector2d from_mm = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_mm = Eigen::Vector2d::Zero();
  double middle_arc_mm = 0.0;  ///< WallHit::arc_mm in its middle
};

/// The luminous wall as a polygon from y < 0 to y > 0, cut exactly at the slot. Its corners lie on
/// the wall, which leaves the strips between them by 1 / 320 of a period at most, or by 1 / 2000 of
/// its size where that is less (but by 2e-5 of its size where periods are very short).
std::vector<WallStrip> wall_outline(const Tunnel& tunnel);

/// The luminous wall's cross-section, cut exactly at the slot.
struct WallSize {
  double length_mm = 0.0;         ///< along the cross-section; right to 1e-6 of it
  Eigen::AlignedBox2d box_yz_mm;  ///< empty without a wall
};

WallSize wall_size(const Tunnel& tunnel);

}  // namespace glint
