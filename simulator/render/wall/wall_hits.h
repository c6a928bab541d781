// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where rays meet the wall of a tunnel.
#pragma once

#include <vector>

#include "core/image/uninitialized_allocator.h"
#include "simulator/light/tunnel/tunnel.h"

namespace glint {

using FloatArray = std::vector<float, UninitializedAllocator<float>>;

/// Where rays meet a tunnel (Tunnel::intersect_block), arrays as in RayCache.
struct WallHits {
  FloatArray x_mm;
  FloatArray y_mm;
  FloatArray margin_mm;
  FloatArray pattern_mm;  ///< empty: equal to x_mm
  FloatArray cosine;      ///< empty: 1

  const FloatArray& stripes_mm() const { return pattern_mm.empty() ? x_mm : pattern_mm; }

  /// For so many rays on a tunnel: only arrays that it needs.
  void resize(std::size_t count, const TunnelSettings& tunnel);

  /// Places in arrays().
  enum : std::size_t { kX, kY, kMargin, kPattern, kCosine };

  /// Those that are not empty: the first three or all.
  std::vector<FloatArray*> arrays();
};

/// Meets some rays. @param hits  written from index `first` on; resized before
void intersect_rays(const RayBlock& rays, const Tunnel& tunnel, std::size_t first, WallHits& hits);

}  // namespace glint
