// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels of rendered frames that are summed from cells, in reverse mode: from derivatives by their
// radiance in each frame to those by hits, stripes, the light of dark stripes and the edges of what
// the wall hides. docs/theory/derivatives.md
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/image/spans.h"
#include "simulator/render/derivative/cell_gradient.h"
#include "simulator/render/derivative/scan_gradient.h"
#include "simulator/render/footprint/visible_part.h"

namespace glint {

class CellPixelGradient {
 public:
  /// @param pixels      of any state; others than those of cells add nothing
  /// @param per_weight  what a derivative by a pixel's radiance is in units of
  CellPixelGradient(const Footprints& footprints,
                    const Spans& pixels,
                    double per_weight,
                    ScanGradient& gradient);

  /// @param by_radiance  derivative by each pixel's radiance in that frame, span after span
  void add_frame(int frame, const std::vector<float>& by_radiance);

  /// Adds what was collected to the gradient.
  void finish();

 private:
  struct Rays;
  struct CellAdder;

  void add_unrefined(std::int32_t pixel);
  void add_refined(const RefinedGroup& group,
                   std::size_t pixel,
                   std::size_t index,
                   RefinedGradient& gradient);
  void finish_cells();
  void turn_to(std::int32_t pixel, const Rays& rays);
  void add_cell(const Rays& rays,
                const std::array<std::size_t, 4>& at,
                const SquareOfPixel& square,
                const CellAdder& add);
  void finish_pixel(std::int32_t pixel, const Rays& rays, const CellAdder& add);
  void add_edges(std::int32_t pixel);
  bool load_weights(std::size_t index);

  const Footprints& footprints_;
  const CornerRays& rays_;
  double per_weight_;
  ScanGradient& gradient_;
  std::size_t frames_;
  std::vector<std::int32_t> cell_pixels_;
  std::vector<std::size_t> places_;   ///< among the given pixels
  std::vector<double> cell_weights_;  ///< frames_ of each
  std::vector<double> weights_;
  WallHits hits_;
  ScanPositions positions_;  ///< with the light of the dark stripes of the pixel in work
  CellGradient cells_;
  double dark_before_ = 0.0;            ///< derivative by dark radiance of the pixels before it
  std::optional<VisiblePart> visible_;  ///< of the pixel in work; empty: all of it
};

}  // namespace glint
