// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rays against the reference part, in double. The smooth surface is met in closed form (a quadratic
// equation). Where a dent or bump lies, the true displaced surface F = 0 is sought from there by
// marching in steps of sigma / 16 and halving the interval in which F changes its sign.
#pragma once

#include <optional>

#include "studies/stability/reference/reference_scene.h"

namespace glint::stability {

struct SurfaceHit {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();  ///< scene frame
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< unit, outwards
};

/// The roots of a t^2 + 2 b t + c = 0 in ascending order; none for a complex pair.
std::optional<std::array<double, 2>> quadratic_roots(double a, double b, double c);

/// The first hit with t > 0. @param direction  unit
std::optional<SurfaceHit> intersect(const ReferencePart& part,
                                    const Eigen::Vector3d& origin_mm,
                                    const Eigen::Vector3d& direction);

/// A ray that leaves a point of the surface and meets a dent's other side; empty: it escapes.
std::optional<SurfaceHit> intersect_again(const ReferencePart& part,
                                          const SurfaceHit& from,
                                          const Eigen::Vector3d& direction);

/// From the middle of a dent, along the plane of the smooth surface there, in defect radii.
double radii_from(const ReferencePart& part,
                  const ReferenceDent& dent,
                  const Eigen::Vector3d& point_mm);

}  // namespace glint::stability
