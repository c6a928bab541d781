// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/tools/surface_sag.h"

#include <algorithm>
#include <cmath>

namespace glint {

SurfaceSag::SurfaceSag(const SurfacePlace& place, const SurfaceBend& bend, double limit_per_mm)
    : place_(place), bend_(bend) {
  const double largest = std::max(std::abs(bend.along_per_mm), std::abs(bend.across_per_mm));
  bend_.along_per_mm = std::clamp(bend.along_per_mm, -limit_per_mm, limit_per_mm);
  bend_.across_per_mm = std::clamp(bend.across_per_mm, -limit_per_mm, limit_per_mm);
  if (largest > limit_per_mm) {
    bend_.patch = nullptr;
  }
  reach_mm_ = 0.5 / largest;  // infinite on a plane
}

double SurfaceSag::parabola_mm(double u_mm, double v_mm) const {
  return 0.5 * (bend_.along_per_mm * u_mm * u_mm + bend_.across_per_mm * v_mm * v_mm);
}

double SurfaceSag::at_mm(double u_mm, double v_mm) const {
  const double distance_mm = std::hypot(u_mm, v_mm);
  if (bend_.patch == nullptr || distance_mm == 0.0) {
    return parabola_mm(u_mm, v_mm);
  }
  const double share = std::min(1.0, reach_mm_ / distance_mm);
  const Ray down = {
      .origin_mm = place_.centre_mm + share * u_mm * place_.u_axis + share * v_mm * place_.v_axis,
      .direction = -place_.normal};
  const double start_mm = parabola_mm(share * u_mm, share * v_mm);
  const auto hit = polish(*bend_.patch, down, start_mm, 0.25 * share * distance_mm);
  return (hit ? hit->t_mm : start_mm) / (share * share);
}

}  // namespace glint
