// SPDX-License-Identifier: GPL-3.0-or-later
//
// A pixel's classification looks at its own corners and their neighbours, from x - 1 to x + 2:
// whatever a changed corner can reclassify is marked, and then every corner that these pixels read.
// Two passes of dilation; cost: linear in the corners. docs/theory/tunnel.md, "What is kept".
#include "simulator/render/corner_rays/update_plan.h"

#include <algorithm>

namespace glint {
namespace {

/// Sets [x0, x1] x [y0, y1], as much of it as there is.
void set_box(Mask& mask, int x0, int x1, int y0, int y1) {
  for (int y = std::max(0, y0); y <= std::min(mask.height() - 1, y1); ++y) {
    for (int x = std::max(0, x0); x <= std::min(mask.width() - 1, x1); ++x) {
      mask(x, y) = 1;
    }
  }
}

/// Corners whose rays may change.
Mask changing_corners(const CornerRays& without_detail, const RefinementNeed& need) {
  const int width = without_detail.width_px;
  const int height = without_detail.height_px;
  Mask corners(width + 1, height + 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (need.cells(x, y) > 0) {
        set_box(corners, x, x + 1, y, y + 1);
      }
    }
  }
  for (const std::int64_t i : without_detail.special) {
    corners.values()[static_cast<std::size_t>(i)] = 1;
  }
  return corners;
}

}  // namespace

UpdatePlan::UpdatePlan(const CornerRays& without_detail, const RefinementNeed& need) {
  const int width = without_detail.width_px;
  const int height = without_detail.height_px;
  const Mask changing = changing_corners(without_detail, need);
  pixels_ = Mask(width, height);
  corners_ = Mask(width + 1, height + 1);
  // A pixel is judged by its corners and their neighbours: those from x - 1 to x + 2.
  for (int y = 0; y <= height; ++y) {
    for (int x = 0; x <= width; ++x) {
      if (changing(x, y) != 0) {
        set_box(pixels_, x - 2, x + 1, y - 2, y + 1);
      }
    }
  }
  for (const RefinedGroup& group : without_detail.refined) {
    const auto rays_each = static_cast<std::int64_t>(group.rays.width_px);
    for (const std::int64_t i : group.special) {
      const std::int32_t pixel = group.pixels[static_cast<std::size_t>(i / rays_each)];
      pixels_.values()[static_cast<std::size_t>(pixel)] = 1;
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (pixels_(x, y) != 0) {
        set_box(corners_, x - 1, x + 2, y - 1, y + 2);
      }
    }
  }
}

}  // namespace glint
