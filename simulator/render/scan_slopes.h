// SPDX-License-Identifier: GPL-3.0-or-later
//
// The derivative of a number that depends on the aspect image, taken backwards through the scan:
// from the slopes by the aspect image to those by the hits of rays and by the settings of stripes
// and sensor. What the shape of the wall or the camera's pose do to the hits is added forwards
// (simulator/light/wall_motion.h), so any number of keys costs one pass
// (docs/theory/derivatives.md).
//
// Exact for smooth cells, with the light's boundaries moving through them. Held, and therefore
// missing where they move: the part's outline, cells of rays that have nothing to do with each
// other, the region, which pixels the wall hides, and the tunnel's ends.
#pragma once

#include <memory>
#include <vector>

#include "simulator/light/wall_motion.h"
#include "simulator/render/closed_scan.h"

namespace glint {

/// Slopes by the hits of a set of rays; empty: none.
struct SlopesByHits {
  std::vector<float> x, y, margin;  ///< [1 / mm]

  void resize(std::size_t rays);

  bool empty() const { return x.empty(); }

  HitSlopes from(std::size_t ray) const {
    return {.x = x.data() + ray, .y = y.data() + ray, .margin = margin.data() + ray};
  }
};

/// Slopes by the rays of some pixels of a RefinedGroup.
struct RefinedSlopes {
  std::vector<std::size_t> pixels;  ///< indices in the group
  SlopesByHits by_hits;             ///< (n + 1)^2 rays of each
};

struct ScanSlopes {
  SlopesByHits corners;                ///< of CornerRays::corners
  std::vector<RefinedSlopes> refined;  ///< of each group
  double period_mm = 0.0;              ///< [1 / mm]
  double offset_mm = 0.0;              ///< [1 / mm]
  double slot_mm = 0.0;                ///< [1 / mm] of the slot's width
  double duty = 0.0;
  double dark = 0.0;  ///< by the radiance of dark stripes
  double gain = 0.0;
  double exposure = 0.0;
  double blur_px = 0.0;  ///< [1 / px]
  /// Collects the slopes by hits where they lie on the wall.
  void collect(const Footprints& footprints, WallMotion& motion) const;

  int held_pixels = 0;  ///< pixels with a slope whose cells are held, in whole or in part
};

/// Slopes that cost extra.
struct WantedSlopes {
  bool duty = true;
  bool dark = true;
  bool gain = true;
  bool exposure = true;
  bool blur = true;
};

/// @param by_aspect  slope of the number by each pixel of the aspect image; 0 outside the region
///                   and the watched pixels of the plan
/// @param plan       of these footprints
/// @param cells      that the scan by this plan was made with (ClosedScan), if known
/// @throws ConfigError under an uneven light
ScanSlopes slopes_of_scan(const Footprints& footprints,
                          const Sensor& sensor,
                          const ScanPlan& plan,
                          double reflectance,
                          const ImageF& by_aspect,
                          const WantedSlopes& wanted = {},
                          const std::shared_ptr<const PixelCells>& cells = nullptr);

/// The same pixels by table and by frames, for footprints nearby: what a central difference needs.
ScanPlan with_same_pixels(const ScanPlan& plan, const Footprints& footprints, const Sensor& sensor);

}  // namespace glint
