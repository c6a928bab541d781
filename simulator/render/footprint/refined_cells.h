// SPDX-License-Identifier: GPL-3.0-or-later
//
// The cells of refined pixels: how their corner rays meet the light, and what of a pixel each of
// them adds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulator/light/tunnel/tunnel.h"
#include "simulator/render/corner_rays/refined_groups.h"
#include "simulator/render/footprint/cell_samples.h"
#include "simulator/render/footprint/cell_sum.h"
#include "simulator/render/footprint/cut_batch.h"
#include "simulator/render/footprint/visible_part.h"

namespace glint {

/// Turned to one pixel after another. References must outlive it.
class RefinedCells {
 public:
  RefinedCells(const ScanPositions& positions, const cut_kernels::CutLimits& limits)
      : positions_(positions), limits_(limits) {}

  /// Where corner rays of pixels [begin, end) of a group meet the light.
  void intersect(const RefinedGroup& group,
                 const Tunnel& tunnel,
                 std::size_t begin,
                 std::size_t end);

  /// The pixel that is added next, one of these.
  /// @return limits of its places along the tunnel [mm], low > high where there are none
  std::array<double, 2> turn_to(std::size_t index);

  /// Radiance of dark stripes over the pixel.
  double mean_dark(const DarkRadiance& dark) const;

  /// Adds the pixel.
  void add_to(CellSum& sum);

  /// Adds what of it the camera sees.
  void add_to(CellSum& sum, const VisiblePart& visible);

 private:
  const unsigned char* find_cut_cells(CellSum& sum);
  void add_smooth_cells(CellSum& sum);
  void add_cut_cells(double share, CellSum& sum);
  /// @param visible  nullptr: all of the pixel
  void add_corners(CellSum& sum, const VisiblePart* visible);
  cut_kernels::CellGrid cells(const unsigned char* is_wanted) const;

  /// The pixel in work.
  struct Pixel {
    std::size_t first = 0;          ///< of its corners among the hits
    const float* weight = nullptr;  ///< of its corners
    const unsigned char* is_smooth = nullptr;
    int cells_per_axis = 0;
  };

  using Marks = std::array<unsigned char, cut_kernels::kMaxCells * cut_kernels::kMaxCells>;

  const ScanPositions& positions_;
  const cut_kernels::CutLimits& limits_;
  const RefinedGroup* group_ = nullptr;
  std::size_t begin_ = 0;  ///< the first pixel of the group whose corners are among the hits
  WallHits hits_;          ///< corner by corner
  Pixel pixel_;
  cut_kernels::PlaceLimits places_;  ///< of the pixel
  std::vector<float> gain_;          ///< of the light at the pixel's corners
  std::vector<float> weight_;        ///< what of it its corners stand for by themselves
  Marks is_lit_ = {}, is_cut_ = {};
  std::vector<std::int32_t> cell_corners_;  ///< first corners of the pixel's cut cells
  CutBatch batch_;
};

}  // namespace glint
