// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/config/keys.h"
#include "simulator/material/local.h"

namespace glint {

/// Keys of [material.lay]: which way the grooves of machining run, in the part's coordinates.
///
/// The tangent of a surface point is the direction of its grooves, so a ground or turned face,
/// rough across its grooves, has anisotropy < 0; the sign turns the roughness by 90 degrees.
struct LaySettings {
  enum class Kind {
    kNone,     ///< the tangent is the direction below, which plays no role without anisotropy
    kTurned,   ///< circles around the axis
    kBrushed,  ///< parallel to the direction
    kMilled    ///< arcs of a face mill that is fed along the direction, in lanes side by side
  };

  Kind kind = Kind::kNone;
  std::vector<double> center_mm = {0.0, 0.0, 0.0};  ///< on the axis; on the middle of a lane
  std::vector<double> axis = {0.0, 0.0, 1.0};       ///< of the lathe or the mill; any length
  std::vector<double> direction = {1.0, 0.0, 0.0};  ///< of brushing or feed; any length
  double mill_radius_mm = 25.0;
  double lane_mm = 40.0;  ///< distance between lanes, at most twice the radius
};

void visit_keys(KeyVisitor& keys, LaySettings& settings);

/// The plane across an axis: u, v and the axis are right-handed. For axis +z and direction +x, u
/// and v are x and y.
struct LayPlane {
  Eigen::Vector3d center_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();

  Eigen::Vector2d at(const Eigen::Vector3d& point_mm) const {
    const Eigen::Vector3d offset_mm = point_mm - center_mm;
    return {u.dot(offset_mm), v.dot(offset_mm)};
  }
};

LayPlane plane_of(const LaySettings& settings);

/// The direction of the grooves at a point, before it is laid into the surface by frame_at(); zero
/// on the axis of a turned part, where there is none.
Eigen::Vector3d groove_at(const LaySettings& settings,
                          const LayPlane& plane,
                          const Eigen::Vector3d& point_mm);

}  // namespace glint
