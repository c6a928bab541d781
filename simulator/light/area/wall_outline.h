// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

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

}  // namespace glint
