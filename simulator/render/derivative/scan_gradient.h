// SPDX-License-Identifier: GPL-3.0-or-later
//
// The derivative of a number that depends on the aspect image, in reverse mode through the scan:
// from the derivatives by the aspect image to those by the hits of rays and by the settings of
// stripes and sensor. What the shape of the wall or the camera's pose do to the hits is added
// in forward mode (simulator/light/tunnel/shape_derivative.h), so any number of keys costs one pass
// (docs/theory/derivatives.md).
//
// Exact for smooth cells, with the light's boundaries and the edges of what the wall hides moving
// through them. Held, and therefore missing where they move: the part's outline, cells of rays that
// have nothing to do with each other, the region, the tunnel's ends, and what the camera's pose
// does to the edges of what the wall hides.
#pragma once

#include <memory>
#include <vector>

#include "simulator/light/tunnel/shape_derivative.h"
#include "simulator/render/footprint/footprint_cells.h"
#include "simulator/render/scan/closed_scan.h"

namespace glint {

/// Derivatives by the hits of a set of rays; empty: none. Few rays change anything by y and margin,
/// those at boundaries of the light: rows of them are opened for that.
class GradientByHits {
 public:
  std::vector<float> x;  ///< [1 / mm]
  FloatArray y, margin;  ///< [1 / mm]; of open rows, elsewhere whatever was in memory

  /// Derivatives of rays that were there stay.
  /// @param row  length of a row, the same whenever this is called
  void resize(std::size_t rows, std::size_t row);

  /// Sets y and margin of a row to 0 if it is not open.
  void open(std::size_t row);

  bool empty() const { return x.empty(); }

  /// Right up to the next row that is not as open as this ray's.
  HitGradient from(std::size_t ray) const {
    const bool has_edges = is_open_[ray / row_] != 0;
    return {.x = x.data() + ray,
            .y = has_edges ? y.data() + ray : nullptr,
            .margin = has_edges ? margin.data() + ray : nullptr};
  }

  /// Calls use(first ray, count, derivatives from it) for rows that are alike, all of them.
  template <class Use>
  void for_each_run(const Use& use) const {
    for (std::size_t begin = 0, end = 0; begin < is_open_.size(); begin = end) {
      while (end < is_open_.size() && is_open_[end] == is_open_[begin]) {
        ++end;
      }
      use(begin * row_, static_cast<int>((end - begin) * row_), from(begin * row_));
    }
  }

 private:
  std::size_t row_ = 0;
  std::vector<unsigned char> is_open_;  ///< row by row
};

/// Derivatives by the rays of some pixels of a RefinedGroup.
struct RefinedGradient {
  std::vector<std::size_t> pixels;  ///< indices in the group
  GradientByHits by_hits;           ///< (n + 1)^2 rays of each
};

/// Derivatives by where the sight lines through the corners of a pixel that is hidden in part cross
/// the wall, as OccludedEdge.
struct EdgeGradient {
  std::int32_t pixel = 0;
  OccludedEdge::Corners x = {}, y = {}, margin = {};  ///< [1 / mm]
};

struct ScanGradient {
  GradientByHits corners;                ///< of CornerRays::corners
  std::vector<RefinedGradient> refined;  ///< of each group
  std::vector<EdgeGradient> edges;       ///< of what the wall hides
  double period_mm = 0.0;                ///< [1 / mm]
  double offset_mm = 0.0;                ///< [1 / mm]
  double slot_mm = 0.0;                  ///< [1 / mm] of the slot's width
  double duty = 0.0;
  double dark = 0.0;  ///< by the radiance of dark stripes, where it is one for all places
  std::vector<double> dark_nodes;  ///< by the nodes of DarkRadiance, where it is not
  double gain = 0.0;
  double exposure = 0.0;
  double blur_px = 0.0;  ///< [1 / px]
  /// Collects the derivatives by hits where they lie on the wall.
  void collect(const Footprints& footprints, ShapeDerivative& motion) const;

  int detached_pixels =
      0;  ///< pixels with a derivative whose cells are treated as constant, in whole or in part
};

/// Derivatives that cost extra.
struct WantedDerivatives {
  bool duty = true;
  bool dark = true;
  bool gain = true;
  bool exposure = true;
  bool blur = true;
};

/// @param by_aspect  derivative of the number by each pixel of the aspect image; 0 outside the
/// region
///                   and the watched pixels of the plan
/// @param plan       of these footprints
/// @param cells      that the scan by this plan was made with (ClosedScan), if known
/// @throws ConfigError under an uneven light
ScanGradient gradient_of_scan(const Footprints& footprints,
                              const Sensor& sensor,
                              const ScanPlan& plan,
                              double reflectance,
                              const ImageF& by_aspect,
                              const WantedDerivatives& wanted = {},
                              const std::shared_ptr<const PixelCells>& cells = nullptr);

}  // namespace glint
