// SPDX-License-Identifier: GPL-3.0-or-later
//
// A curve as a workshop bends it: arcs and straight pieces one after the other.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace glint {

/// A piece of a circle, or of a line.
struct Arc {
  Eigen::Vector2d from_mm = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_mm = Eigen::Vector2d::Zero();
  double bulge = 0.0;  ///< tangent of a quarter of its angle, > 0: counterclockwise; 0: straight

  double angle_rad() const;         ///< >= 0
  double radius_mm() const;         ///< infinite where it is straight
  Eigen::Vector2d centre() const;   ///< of an arc
  Eigen::Vector2d highest() const;  ///< the point midway along it
};

/// Largest distance of the wall from the arcs that stand for it in drawings.
inline constexpr double kArcTolerance_mm = 0.1;

/// Few arcs along a polyline, each from one of its points to another, no point farther from them
/// than the tolerance. Consecutive arcs meet in a point, with tangents that differ by little. Each
/// is as long as the tolerance allows, so that their number is small, not the smallest.
/// @param points  at least 2
std::vector<Arc> arcs_through(const std::vector<Eigen::Vector2d>& points,
                              double tolerance_mm = kArcTolerance_mm);

/// The arc on the other side of the axis on which the first coordinate is 0.
Arc mirrored(const Arc& arc);

}  // namespace glint
