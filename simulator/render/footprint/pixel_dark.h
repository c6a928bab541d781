// SPDX-License-Identifier: GPL-3.0-or-later
//
// Radiance of dark stripes over a pixel where it depends on the place: it varies slowly, so its
// mean over the pixel's rays stands for the pixel.
#pragma once

#include <cstddef>
#include <span>

#include "simulator/light/tunnel/dark_radiance.h"
#include "simulator/render/wall/wall_hits.h"

namespace glint {

/// True for a ray that comes from the part and meets the wall, or where it would run on.
inline bool has_place(const WallHits& hits, const float* weight, std::size_t ray) {
  return weight[ray] > 0.0F && hits.margin_mm[ray] > kNoHitMargin_mm;
}

/// The mean over those of some rays that have a place; 0 without any.
/// @param weight  of rays, as the hits
double mean_dark(const DarkRadiance& dark,
                 const WallHits& hits,
                 const float* weight,
                 std::span<const std::size_t> rays);

/// Derivatives by the place of each hit, arrays of as many as the hits.
struct HitDerivatives {
  float* y = nullptr;
  float* margin = nullptr;
};

/// Adds the derivatives of mean_dark() times `factor`: by the nodes of `dark` to by_nodes, and by
/// the rays' places to by_hits.
void add_mean_dark_gradient(const DarkRadiance& dark,
                            const WallHits& hits,
                            const float* weight,
                            std::span<const std::size_t> rays,
                            double factor,
                            std::span<double> by_nodes,
                            const HitDerivatives& by_hits);

}  // namespace glint
