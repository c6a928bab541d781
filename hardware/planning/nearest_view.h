// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include <Eigen/Geometry>

namespace glint {

/// A pose near a view that can be taken: moved back along the optical axis by up to 200 mm, or
/// nearer by up to 740 mm and four fifths of the distance to the point that it looks at, rolled
/// about it, tilted by up to 30 degrees about the point that the view looks at, or up to two of
/// these together. Near is what moves the camera least; a roll counts as if it moved it by
/// 0.2 mm per degree. Between the nearest of a grid and the view the distance is halved five times
/// more.
/// @param base_from_camera  of the view, mm
/// @param target_mm         from the pinhole to the point that it looks at, > 0
/// @return none where no pose of the grid can be taken
std::optional<Eigen::Isometry3d> nearest_view(
    const Eigen::Isometry3d& base_from_camera,
    double target_mm,
    const std::function<bool(const Eigen::Isometry3d&)>& can_be_taken);

}  // namespace glint
