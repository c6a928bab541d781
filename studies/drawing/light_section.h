// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a drawing of area lights from the side shows, in mm.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "simulator/render/path_tracing/physical_scene.h"

namespace glint {

/// The plane of the drawing: through the camera, z upwards.
struct DrawingPlane {
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();
  std::string across_name = "y";

  Eigen::Vector3d normal() const { return across.cross(Eigen::Vector3d::UnitZ()); }

  /// A point's place in the plane.
  Eigen::Vector2d operator()(const Eigen::Vector3d& point_mm) const {
    return {across.dot(point_mm), point_mm.z()};
  }
};

/// A line in the plane, mm.
using PlaneLine = std::vector<Eigen::Vector2d>;

/// What is drawn of the lights, in mm.
struct LightLines {
  std::vector<PlaneLine> cut;   ///< where the plane meets luminous surfaces
  std::vector<PlaneLine> seen;  ///< outlines of what is seen from the side
};

/// The plane in which lights are best seen: that of the camera's view; looking down, across the
/// direction in which the lights are set apart, else y.
DrawingPlane drawing_plane(const PhysicalScene& scene);

/// Rings and domes are cut where the plane meets them near their middle, all others, and those that
/// it does not meet, are seen from the side.
LightLines light_lines_in(const PhysicalScene& scene, const DrawingPlane& section);

/// The convex hull of the part's shadow.
PlaneLine part_outline(const TriangleMesh& mesh, const DrawingPlane& section);

}  // namespace glint
