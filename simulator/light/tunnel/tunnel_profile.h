// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cross-sections of a tunnel in double: how they are built from their settings and where a line in
// the y-z plane meets them. Two-dimensional vectors hold (y, z).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "simulator/light/tunnel/spline_kernels.h"
#include "simulator/light/tunnel/tunnel_kernels.h"

namespace glint {

struct EllipseAxes {
  double half_width_mm = 0.0;
  double height_mm = 0.0;
};

/// Left (y < 0) and right panel of a flat tunnel; each ends at the middle plane at the latest.
std::vector<FlatWall> flat_walls(double distance_mm,
                                 double opening_rad,
                                 double panel_height_mm,
                                 double base_mm);

/// Of a piece of a spline. @param c  four coefficients, in powers of u
inline double cubic_at(const double* c, double u) {
  return c[0] + u * (c[1] + u * (c[2] + u * c[3]));
}

/// The clamped uniform cubic B-spline through control points at radii control_mm, at equal angles
/// from the rim (90 degrees from the vertical) to the top and mirrored; from y < 0 to y > 0.
/// Source: C. de Boor, "A Practical Guide to Splines" (Boehm's knot insertion to Bezier form).
std::vector<SplineSegment> free_segments(const std::vector<double>& control_mm, double base_mm);

/// The same curve with a long straight piece along its tangent at either end.
std::vector<SplineSegment> with_straight_ends(const std::vector<SplineSegment>& segments);

/// Points of a dense profile.
inline constexpr int kProfilePoints = 2049;

std::vector<Eigen::Vector2d> sample_spline(const std::vector<SplineSegment>& segments,
                                           int num_points);

/// kProfilePoints of them.
std::vector<Eigen::Vector2d> sample_superellipse(const EllipseAxes& axes,
                                                 double exponent,
                                                 double base_mm);

/// Distance along the ray (in directions) to the nearest crossing beyond min_t; empty for none.
std::optional<double> hit_walls(const std::vector<FlatWall>& walls,
                                const Eigen::Vector2d& origin,
                                const Eigen::Vector2d& direction,
                                double min_t);
std::optional<double> hit_segments(const std::vector<SplineSegment>& segments,
                                   const Eigen::Vector2d& origin,
                                   const Eigen::Vector2d& direction,
                                   double min_t);
std::optional<double> hit_superellipse_exact(const EllipseAxes& axes,
                                             double exponent,
                                             double base_mm,
                                             const Eigen::Vector2d& origin,
                                             const Eigen::Vector2d& direction,
                                             double min_t);

}  // namespace glint
