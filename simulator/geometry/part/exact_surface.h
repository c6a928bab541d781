// SPDX-License-Identifier: GPL-3.0-or-later
//
// Exact surfaces behind the triangles of a parametric part. The triangles find the ray's hit (the
// BVH knows only triangles, in float); Newton's method along the ray then moves it onto the exact
// surface, so that position and normal carry no facet and no rounding to float.
#pragma once

#include <limits>
#include <optional>
#include <variant>

#include <Eigen/Core>

#include "core/pose.h"
#include "simulator/geometry/part/exact_kernels.h"

namespace glint {

/// The plane z = 0 of the patch frame; outwards is +z.
struct PlanePatch {};

/// z = -x^2 / (2 R_along) - y^2 / (2 R_across): apex at the origin, outwards is +z.
/// Radii in mm; infinite = straight, negative = concave.
struct ParaboloidPatch {
  double radius_along_mm = std::numeric_limits<double>::infinity();
  double radius_across_mm = std::numeric_limits<double>::infinity();
};

/// A sphere around the origin of the patch frame.
struct SpherePatch {
  double radius_mm = 1.0;
};

/// A cylinder around the x axis of the patch frame.
struct CylinderPatch {
  double radius_mm = 1.0;
  bool is_bore = false;  ///< outwards is towards the axis
};

/// A flank of a spur gear around the x axis of the patch frame. The involute of the base circle
/// leaves it at start_rad (measured from +y towards +z) and turns forward (hand = +1, the flank at
/// the smaller angle of a tooth) or backward (-1); inside the base circle the flank is radial.
struct InvolutePatch {
  double base_radius_mm = 1.0;
  double start_rad = 0.0;
  double hand = 1.0;  ///< +1 or -1
};

using PatchShape =
    std::variant<PlanePatch, ParaboloidPatch, SpherePatch, CylinderPatch, InvolutePatch>;

/// An exact surface and where it lies. Only the part of it that the triangles cover is meant.
struct ExactPatch {
  PatchShape shape = {};
  RigidTransform scene_from_patch = {};
};

/// F(p), zero on the surface and growing outwards; p and the gradient in the scene frame.
/// F is in mm and |gradient| close to 1 near the surface (exactly 1 for all but the paraboloid and
/// the radial part of a flank). @param gradient may be nullptr
double implicit_value(const ExactPatch& patch,
                      const Eigen::Vector3d& p_mm,
                      Eigen::Vector3d* gradient);

/// Where a ray meets a surface.
struct SurfaceHit {
  double t_mm = 0.0;  ///< along the ray
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, outwards
};

/// The hit of a ray (unit direction) with the exact surface by Newton's method from a start
/// nearby, to about 1e-12 mm. Empty when it does not converge, or would move by more than
/// max_move_mm along the ray (grazing rays near a silhouette): keep the triangle's hit then.
std::optional<SurfaceHit> polish(const ExactPatch& patch,
                                 const Ray& ray,
                                 double start_t_mm,
                                 double max_move_mm);

/// The patch for polish16().
PatchCoefficients coefficients_of(const ExactPatch& patch);

}  // namespace glint
