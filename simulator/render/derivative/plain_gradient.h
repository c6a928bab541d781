// SPDX-License-Identifier: GPL-3.0-or-later
//
// Plain pixels of rendered frames in reverse mode: from derivatives by their radiance in each frame
// to those by hits, stripes and dark radiance.
#pragma once

#include <vector>

#include "core/image/spans.h"
#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/render/derivative/scan_gradient.h"

namespace glint {

class PlainGradient {
 public:
  /// @param pixels  of any state; others than plain ones add nothing
  PlainGradient(const Footprints& footprints, const Spans& pixels);

  /// @param by_radiance  of frame first, first + 1, ...: derivative by each pixel, span after span
  void add_frames(int first, const std::vector<std::vector<float>>& by_radiance);

  /// Adds what was collected. @param per_weight  what a derivative by a pixel's radiance is in
  /// units of
  void finish(double per_weight, ScanGradient& gradient) const;

 private:
  struct Tile;

  void find_dark();
  void add_dark_nodes(double per_weight, ScanGradient& gradient) const;
  void add_narrow(int first,
                  const std::vector<std::vector<float>>& by_radiance,
                  std::size_t begin,
                  Tile& tile);
  void add_wide(int first,
                const std::vector<std::vector<float>>& by_radiance,
                std::size_t begin,
                Tile& tile);

  const Footprints& footprints_;
  const Spans& pixels_;
  std::vector<double> phase_;  ///< pixel by pixel, span after span, as all of them
  std::vector<gradient_kernels::FixedPhase> v_;
  std::vector<float> gx_, gy_, gain_;
  std::vector<float> by_v_, by_gx_, by_gy_;
  std::vector<unsigned char> is_narrow_;  ///< tile by tile: each sees one edge at most
  double duty_ = 0.0;
  double dark_ = 0.0;
  // Where the radiance of dark stripes depends on the place, else empty:
  std::vector<float> bright_;    ///< what bright stripes add to it, pixel by pixel
  std::vector<double> by_dark_;  ///< times bright_
};

}  // namespace glint
