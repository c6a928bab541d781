// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/wall/revolved_rays.h"

#include "simulator/render/wall/revolved_kernels.h"

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
  const auto count = static_cast<int>(rays.weight.size());
  const RayBlock block = rays.block(0, count);
  revolved_kernels::revolve({.origin_x = block.origin_x,
                             .origin_y = block.origin_y,
                             .origin_z = block.origin_z,
                             .direction_x = block.direction_x,
                             .direction_y = block.direction_y,
                             .direction_z = block.direction_z},
                            count,
                            base_mm,
                            result.a_mm.data(),
                            result.m.data(),
                            result.h_mm.data(),
                            result.ey.data(),
                            result.ez.data());
  return result;
}

WallHits meet_revolved(const RevolvedRays& rays, const Tunnel& tunnel) {
  WallHits hits;
  for (auto* array : {&hits.x_mm, &hits.y_mm, &hits.margin_mm}) {
    array->resize(rays.a_mm.size());
  }
  revolved_kernels::meet_revolved({.a_mm = rays.a_mm.data(),
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
