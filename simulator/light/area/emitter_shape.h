// SPDX-License-Identifier: GPL-3.0-or-later
//
// Luminous surfaces. Each has a front, the side its normal points to: only that side shines.
// docs/theory/lights.md
#pragma once

#include <optional>
#include <variant>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/pose.h"
#include "core/units.h"

namespace glint {

/// Where a surface stands: unit axes, right-handed, z is its normal or its axis.
struct EmitterFrame {
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  Eigen::Vector3d z = Eigen::Vector3d::UnitZ();

  Eigen::Vector3d local(const Eigen::Vector3d& v) const { return {v.dot(x), v.dot(y), v.dot(z)}; }

  Eigen::Vector3d global(const Eigen::Vector3d& v) const {
    return v.x() * x + v.y() * y + v.z() * z;
  }
};

/// Any right-handed frame with that z axis (unit).
EmitterFrame frame_around(const Eigen::Vector3d& origin_mm, const Eigen::Vector3d& z);

/// Centred on its frame's origin.
struct RectangleShape {
  EmitterFrame frame;
  double half_x_mm = 1.0;
  double half_y_mm = 1.0;
};

/// A disc, an annulus or a sector of one around the frame's z axis, tilted along its middle radius
/// by tilt_rad: > 0 turns its front towards the axis (a piece of a cone), pi / 2 makes a cylinder.
struct RingShape {
  EmitterFrame frame;
  double middle_radius_mm = 1.0;
  double width_mm = 2.0;  ///< along the slope; width cos(tilt) / 2 <= middle radius
  double tilt_rad = 0.0;  ///< in [-pi / 2, pi / 2]
  double first_rad = 0.0;
  double span_rad = 2.0 * kPi;

  double inner_radius_mm() const;
  double outer_radius_mm() const;
};

/// The part of a sphere around the frame's origin between two angles from its z axis; its front is
/// the inside.
struct CapShape {
  EmitterFrame frame;
  double radius_mm = 1.0;
  double top_rad = 0.0;        ///< >= 0: where the opening around the z axis ends
  double rim_rad = kPi / 2.0;  ///< <= pi
};

/// Its normal is (b - a) x (c - a).
struct TriangleShape {
  Eigen::Vector3d a_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d b_mm = Eigen::Vector3d::UnitX();
  Eigen::Vector3d c_mm = Eigen::Vector3d::UnitY();
};

using EmitterShape = std::variant<RectangleShape, RingShape, CapShape, TriangleShape>;

/// A point of a surface.
struct ShapePoint {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// Where a ray meets a surface.
struct ShapeCrossing {
  double distance_mm = 0.0;
  double cosine = 0.0;  ///< between normal and the way back; > 0: the front is met
};

/// All normals lie within half_angle_rad of the axis.
struct NormalCone {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double half_angle_rad = 0.0;
};

double area_mm2(const EmitterShape& shape);

/// Uniform over the area. @param u, v  in [0, 1)
ShapePoint point_on(const EmitterShape& shape, double u, double v);

Eigen::AlignedBox3d bounds_mm(const EmitterShape& shape);
NormalCone normal_cone(const EmitterShape& shape);

/// The nearest place before max_mm where the ray meets the surface, or only its front.
std::optional<ShapeCrossing> cross(const EmitterShape& shape,
                                   const Ray& ray,
                                   double max_mm,
                                   bool fronts_only);

/// False when no point of the surface shows its front to that point.
bool shows_front(const EmitterShape& shape, const Eigen::Vector3d& point_mm);

}  // namespace glint
