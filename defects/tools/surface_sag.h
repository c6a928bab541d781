// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "simulator/geometry/part/exact_surface.h"
#include "simulator/geometry/surface/surface_detail.h"

namespace glint {

/// How the smooth surface bends at a defect's place, along its u and v axis [1/mm]: positive where
/// it bends away from the normal (1 / radius of a ball seen from outside), 0 = flat.
struct SurfaceBend {
  double along_per_mm = 0.0;
  double across_per_mm = 0.0;
  const ExactPatch* patch = nullptr;  ///< the exact surface there; nullptr: none, a parabola does
};

/// How far the smooth surface lies below the tangent plane at a place.
class SurfaceSag {
 public:
  /// A bend above the limit is cut back to it, and then the parabola counts.
  /// @param bend  its patch, when there is one, must outlive this
  SurfaceSag(const SurfacePlace& place, const SurfaceBend& bend, double limit_per_mm);

  /// At a point of the tangent plane [mm]. Of an exact surface to 1e-12 mm within half its smallest
  /// radius of curvature; from there it goes on as a parabola, for a surface may end.
  double at_mm(double u_mm, double v_mm) const;

  bool is_flat() const { return bend_.along_per_mm == 0.0 && bend_.across_per_mm == 0.0; }

 private:
  double parabola_mm(double u_mm, double v_mm) const;

  SurfacePlace place_;
  SurfaceBend bend_;
  double reach_mm_ = 0.0;  ///< of the exact surface
};

}  // namespace glint
