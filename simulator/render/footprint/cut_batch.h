// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels, or cells of a refined one, that one straight boundary of the light may cut: read from
// their corners and worked on together (cut_kernels.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "simulator/render/footprint/cut_kernels.h"
#include "simulator/render/footprint/cut_limits.h"
#include "simulator/render/footprint/footprints.h"

namespace glint {

class CutBatch {
 public:
  /// Reads the corners of some places of a grid, as many as go together; none is simple.
  /// @param weight   of rays, corner by corner
  /// @param first    of the grid's corners among the hits
  /// @param below    from a corner to the one below it
  /// @param corners  the first one of each place
  void load(const WallHits& hits,
            const float* weight,
            std::size_t first,
            std::int32_t below,
            std::span<const std::int32_t> corners);

  std::size_t size() const { return static_cast<std::size_t>(corners_.count); }

  const cut_kernels::CornerBatch& corners() const { return corners_; }

  /// Simple places are those that one line describes.
  void find_cuts(const cut_kernels::CutLimits& limits);

  bool is_simple(std::size_t i) const { return is_simple_[i] != 0; }

  /// What the light leaves of simple places; after find_cuts().
  void cut(const ScanPositions& positions);

  /// Radiance at one position, right for simple places; after cut().
  /// @param radiance  of kBatch places
  void integrate(const ScanPositions& positions, std::size_t position, float* radiance) const;

  /// The sum over simple places.
  float sum_simple(const float* radiance) const {
    return cut_kernels::sum_simple(radiance, is_simple_.data());
  }

 private:
  cut_kernels::CornerBatch corners_;
  cut_kernels::LinearBatch inside_;
  cut_kernels::CutSums sums_;
  std::array<unsigned char, cut_kernels::kBatch> is_simple_ = {};
};

}  // namespace glint
