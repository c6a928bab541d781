// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the part is without any guess: from which the refinement by pictures starts.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace glint {

/// A point of the part and the ray of a camera on which it was seen.
struct PartRay {
  Eigen::Vector3d part_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();   ///< the camera, in the base
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, in the base
};

/// base_from_part with all points near their rays, for any number of cameras: orthogonal iteration
/// from 60 rotations that lie evenly. Distances from the rays count, not those in the picture.
/// @return the solutions that differ, the best first, at most 4: few points that lie in a plane and
///         are seen from afar have two. Empty with fewer than 3 points, or with points on a line
///
/// Source: C.-P. Lu, G. Hager, E. Mjolsness, "Fast and globally convergent pose estimation from
/// video images", IEEE TPAMI 22(6), 2000; rays of several cameras take the place of one's.
std::vector<Eigen::Isometry3d> first_placements(std::span<const PartRay> rays);

}  // namespace glint
