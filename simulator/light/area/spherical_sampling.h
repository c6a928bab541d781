// SPDX-License-Identifier: GPL-3.0-or-later
//
// Directions that are uniform over the solid angle of a rectangle or a triangle, seen from a point.
// Sources: C. Urena, M. Fajardo, A. King, "An area-preserving parametrization for spherical
// rectangles", CGF 32(4), 2013; J. Arvo, "Stratified sampling of spherical triangles", SIGGRAPH
// 1995; A. Van Oosterom, J. Strackee, "The solid angle of a plane triangle", IEEE TBME 30(2), 1983.
#pragma once

#include <Eigen/Core>

namespace glint {

/// A rectangle in the axes of its own sides, as seen from the origin of that frame: it spans
/// [x0, x1] x [y0, y1] at height z.
class SphericalRectangle {
 public:
  /// @param z_mm  not 0
  SphericalRectangle(double x0_mm, double x1_mm, double y0_mm, double y1_mm, double z_mm);

  double solid_angle_sr() const { return solid_angle_sr_; }

  /// The point of the rectangle in which a direction that is uniform over the solid angle meets it.
  /// @param u, v  in [0, 1)
  Eigen::Vector2d point_mm(double u, double v) const;

 private:
  double x0_, x1_, y0_, y1_, z_;
  double b0_, b1_, k_, solid_angle_sr_;
};

/// The solid angle of a triangle whose corners lie in these unit directions; >= 0.
double triangle_solid_angle_sr(const Eigen::Vector3d& a,
                               const Eigen::Vector3d& b,
                               const Eigen::Vector3d& c);

/// A unit direction that is uniform over the spherical triangle of three unit directions.
/// @param u, v  in [0, 1)
Eigen::Vector3d sample_spherical_triangle(const Eigen::Vector3d& a,
                                          const Eigen::Vector3d& b,
                                          const Eigen::Vector3d& c,
                                          double u,
                                          double v);

}  // namespace glint
