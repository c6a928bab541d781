// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/places/sample_wall.h"

#include <algorithm>
#include <limits>

#include "simulator/geometry/surface/surface_path.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kNever_mm = std::numeric_limits<double>::infinity();

}  // namespace

/// The ray begins on the smooth surface, which may lie over the facets or under them: what it
/// enters through is passed over, and so is what lies within the rounding of the ray tracer.
double wall_below(const Part& part,
                  const Bvh& bvh,
                  const Vector3d& point_mm,
                  const Vector3d& normal) {
  constexpr int kMaxHits = 64;
  const double diagonal_mm = part.box_in_part_mm.size_mm().norm();
  const double skip_mm = 1e-5 * diagonal_mm;
  double begin_mm = skip_mm;
  for (int i = 0; i < kMaxHits; ++i) {
    const Hit hit = bvh.intersect(point_mm, -normal, begin_mm, 2.0 * diagonal_mm);
    if (!hit) {
      return kNever_mm;
    }
    const auto t_mm = static_cast<double>(hit.t_mm);
    if (geometric_normal(part.mesh, hit).dot(normal) < 0.0) {
      return t_mm;
    }
    begin_mm = t_mm + skip_mm;
  }
  return kNever_mm;
}

double wall_below(const Part& part, const Bvh& bvh, const Defect& defect) {
  constexpr double kStepsPerSide = 8.0;
  const SurfacePlace& place = defect.place;
  double wall_mm = wall_below(part, bvh, place.centre_mm, place.normal);
  const double half_mm = defect.half_line_mm();
  if (half_mm > 0.0) {
    for (const SurfacePathPoint& at :
         surface_path(part, bvh, place, half_mm, half_mm / kStepsPerSide)) {
      wall_mm = std::min(wall_mm, wall_below(part, bvh, at.point_mm, at.normal));
    }
  }
  return wall_mm;
}

}  // namespace glint
