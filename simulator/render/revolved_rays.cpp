// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/revolved_rays.h"

#include <cmath>

namespace glint {

bool is_revolved(const TunnelSettings& tunnel) {
  return tunnel.shape == TunnelSettings::Shape::kSemicylinder && tunnel.orientation_rad == 0.0 &&
         !tunnel.cosine_law;
}

RevolvedRays revolve(const RayCache& rays, double base_mm) {
  RevolvedRays result;
  result.base_mm = base_mm;
  for (auto* array : {&result.a_mm, &result.m, &result.h_mm, &result.ey, &result.ez}) {
    array->resize(rays.weight.size());
  }
  for (std::size_t i = 0; i < rays.weight.size(); ++i) {
    const auto dy = static_cast<double>(rays.direction_y[i]);
    const auto dz = static_cast<double>(rays.direction_z[i]);
    const auto oy = static_cast<double>(rays.origin_y[i]);
    const double oz = static_cast<double>(rays.origin_z[i]) - base_mm;
    const double length = std::hypot(dy, dz);
    const double ey = length > 0.0 ? dy / length : 0.0;
    const double ez = length > 0.0 ? dz / length : 0.0;
    const double m = length > 0.0 ? static_cast<double>(rays.direction_x[i]) / length : 0.0;
    const double from_foot = oy * ey + oz * ez;
    result.a_mm[i] = static_cast<float>(static_cast<double>(rays.origin_x[i]) - m * from_foot);
    result.m[i] = static_cast<float>(m);
    result.h_mm[i] = static_cast<float>(oy * ez - oz * ey);
    result.ey[i] = static_cast<float>(ey);
    result.ez[i] = static_cast<float>(ez);
  }
  return result;
}

WallHits meet_revolved(const RevolvedRays& rays, const Tunnel& tunnel) {
  WallHits hits;
  for (auto* array : {&hits.x_mm, &hits.y_mm, &hits.margin_mm}) {
    array->resize(rays.a_mm.size());
  }
  footprint_kernels::meet_revolved({.a_mm = rays.a_mm.data(),
                                    .m = rays.m.data(),
                                    .h_mm = rays.h_mm.data(),
                                    .ey = rays.ey.data(),
                                    .ez = rays.ez.data()},
                                   static_cast<int>(rays.a_mm.size()),
                                   static_cast<float>(tunnel.settings().radius_mm),
                                   kNowhere_mm,
                                   hits.x_mm.data(),
                                   hits.y_mm.data(),
                                   hits.margin_mm.data());
  return hits;
}

}  // namespace glint
