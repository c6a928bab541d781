// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/wall/wall_hits.h"

namespace glint {
namespace {

/// Rays that are met together: their arrays stay in the first caches.
constexpr int kBlock = 1024;

bool has_details(const TunnelSettings& tunnel) {
  return tunnel.orientation_rad != 0.0 || tunnel.cosine_law;
}

}  // namespace

void WallHits::resize(std::size_t count, const TunnelSettings& tunnel) {
  for (auto* array : {&x_mm, &y_mm, &margin_mm}) {
    array->resize(count);
  }
  for (auto* array : {&pattern_mm, &cosine}) {
    array->resize(has_details(tunnel) ? count : 0);
  }
}

std::vector<FloatArray*> WallHits::arrays() {
  std::vector<FloatArray*> used;
  for (FloatArray* array : {&x_mm, &y_mm, &margin_mm, &pattern_mm, &cosine}) {
    if (!array->empty()) {
      used.push_back(array);
    }
  }
  return used;
}

void intersect_rays(const RayBlock& rays, const Tunnel& tunnel, std::size_t first, WallHits& hits) {
  for (int done = 0; done < rays.count; done += kBlock) {
    const RayBlock block = part_of(rays, done, kBlock);
    const std::size_t at = first + static_cast<std::size_t>(done);
    float* x = hits.x_mm.data() + at;
    float* y = hits.y_mm.data() + at;
    float* margin = hits.margin_mm.data() + at;
    tunnel.intersect_block(block, x, y, margin);
    if (!hits.pattern_mm.empty()) {
      tunnel.hit_details(block, x, y, margin, hits.pattern_mm.data() + at, hits.cosine.data() + at);
    }
  }
}

}  // namespace glint
