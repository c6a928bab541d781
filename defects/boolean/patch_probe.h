// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "defects/boolean/box_tree.h"
#include "defects/boolean/corefine.h"

namespace glint {

/// A half line that counts the faces it crosses.
struct Probe {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;

  bool may_intersect(const FloatBox& box) const;
  bool hits(const Corners& corners) const;
};

/// Is a point inside a closed surface? visit(probe) returns how many faces a probe hits. Three
/// probes vote, for one may pass through an edge; along none of them runs an edge of usual parts.
template <class Visit>
bool is_inside_surface(const Eigen::Vector3d& point, const Visit& count_hits) {
  const std::array<Eigen::Vector3d, 3> directions = {Eigen::Vector3d(0.5377, 0.6912, 0.4831),
                                                     Eigen::Vector3d(-0.3713, 0.5281, 0.7637),
                                                     Eigen::Vector3d(0.6173, -0.7211, 0.3145)};
  int votes = 0;
  for (const Eigen::Vector3d& direction : directions) {
    votes += count_hits(Probe{point, direction}) % 2;
  }
  return votes >= 2;
}

}  // namespace glint
