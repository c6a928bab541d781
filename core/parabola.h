// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace glint {

/// What values at three nodes in ascending order count for at a place: those of the parabola
/// through them; where the first two are the same node, of the line through the outer ones; where
/// all are, the first alone.
inline std::array<double, 3> parabola_shares(const std::array<int, 3>& nodes, double at) {
  const double way = nodes[2] - nodes[0];
  if (nodes[1] == nodes[0]) {
    const double share = way > 0.0 ? (at - nodes[0]) / way : 0.0;
    return {1.0 - share, 0.0, share};
  }
  const double before = nodes[1] - nodes[0];
  const double after = nodes[2] - nodes[1];
  return {(at - nodes[1]) * (at - nodes[2]) / (before * way),
          (at - nodes[0]) * (nodes[2] - at) / (before * after),
          (at - nodes[0]) * (at - nodes[1]) / (way * after)};
}

}  // namespace glint
