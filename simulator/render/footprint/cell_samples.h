// SPDX-License-Identifier: GPL-3.0-or-later
//
// A refined pixel's cells taken as samples, row by row, in loops free of Eigen that can be compiled
// for wide instruction sets (docs/decisions/0002-bit-identical-results.md).
#pragma once

namespace glint::cut_kernels {

/// Limits of places that have weight; low > high where there are none.
struct PlaceLimits {
  float x_low_mm = 0.0F, x_high_mm = 0.0F;
  float y_low_mm = 0.0F, y_high_mm = 0.0F;
  float margin_low_mm = 0.0F;
};

PlaceLimits find_limits(
    const float* x_mm, const float* y_mm, const float* margin_mm, const float* weight, int count);

/// The cells of a refined pixel, (n + 1)^2 corners around n x n cells.
struct CellGrid {
  const float* stripes_mm = nullptr;
  const float* gain = nullptr;               ///< of the light at the corners
  const unsigned char* is_smooth = nullptr;  ///< 1 or 0
  int cells_per_axis = 0;
};

/// Footprints as sum_box_frames() takes them; cells that are not smooth have gain 0.
struct CellSamples {
  float* v = nullptr;
  float* gx = nullptr;
  float* gy = nullptr;
  float* gain = nullptr;
};

/// Of 2, 4, 8 or 16 cells per axis.
/// @return by how much the stripes differ between corners of a smooth cell at most [mm]; infinity
///         for other numbers of cells, which are not sampled
float sample_cells(const CellGrid& cells, float offset_mm, float per_mm, const CellSamples& out);

inline constexpr int kMaxCells = 16;  ///< per axis

/// What of a refined pixel the corners of cells that are not smooth stand for: a quarter of each.
/// @param is_smooth  1 or 0, row by row
/// @param weight     of (n + 1)^2 corners
void corner_weights(const unsigned char* is_smooth, int cells_per_axis, float* weight);

}  // namespace glint::cut_kernels
