// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels that one straight boundary of the light cuts, many at a time: what PixelPolygon and
// StripeSum (stripe_integral.h) do for any polygon, in loops free of Eigen that can be compiled for
// wide instruction sets (docs/decisions/0002-bit-identical-results.md).
#pragma once

#include <cstdint>

namespace glint::cut_kernels {

/// Pixels that are worked on together.
inline constexpr int kBatch = 64;

/// One quantity at the corners (x0 y0, x1 y0, x0 y1, x1 y1) of pixels.
struct Corners {
  alignas(64) float at[4][kBatch];
};

/// Reads the corners of some pixels from a grid.
/// @param first  of each pixel: index of its corner x0 y0
/// @param below  from a corner to the one below it
void gather(const float* values,
            const std::int32_t* first,
            std::int32_t below,
            int count,
            Corners& corners);

/// values *= factors
void scale(const Corners& factors, int count, Corners& values);

/// Pixels by their corners.
struct CornerBatch {
  int count = 0;
  Corners x_mm, y_mm, margin_mm, stripes_mm;
  Corners gain;
};

/// Boundaries of the light and where they are looked for.
struct CutLimits {
  double half_slot_mm = 0.0;
  float x_low_mm = 0.0F;  ///< the tunnel's ends never pass what is between these
  float x_high_mm = 0.0F;
  float nowhere_mm = 0.0F;  ///< lower margins are no places on the wall
};

/// value + x dx + y dy over each pixel, x and y from -1/2 to 1/2.
struct LinearBatch {
  alignas(64) double value[kBatch], dx[kBatch], dy[kBatch];
};

/// What of each pixel the slot's edge or the rim leaves: where `inside` is >= 0.
/// @param is_simple  1 for pixels that one line describes, 0 for others: both boundaries, two edges
///                   of the slot, ends, or corners beside the wall
void find_cuts(const CornerBatch& pixels,
               const CutLimits& limits,
               LinearBatch& inside,
               unsigned char* is_simple);

/// A square cut by a line: its corners (x0 y0, x1 y0, x1 y1, x0 y1), then where the line leaves and
/// where it enters the part that is kept.
inline constexpr int kVertices = 6;

/// The StripeSum of each pixel. Vertices that it does not have count nothing.
struct CutSums {
  alignas(64) double area[kBatch];
  alignas(64) double phase[kVertices][kBatch], second[kVertices][kBatch], first[kVertices][kBatch];
  bool has_first = false;  ///< one of `first` is not 0
};

/// @param per_mm  periods
void cut(const CornerBatch& pixels,
         const LinearBatch& inside,
         double offset_mm,
         double per_mm,
         CutSums& sums);

/// Stripes that have moved by `shift` periods, bright on `duty` of a period.
struct CutFrame {
  double shift = 0.0;
  double duty = 0.5;
  double dark = 0.0;    ///< radiance of dark stripes
  double bright = 1.0;  ///< what bright ones add to it
};

/// out = mean of the corners' gain * (dark * area + bright * share)
void integrate(const CornerBatch& pixels, const CutSums& sums, const CutFrame& frame, float* out);

/// The mean of the corners' gain where it is > 0.
/// @param is_clear  1 where at least two corners have gain, and a boundary of the light is further
///                  from them than they are from each other
void mean_gains(const CornerBatch& pixels,
                const CutLimits& limits,
                float* gain,
                unsigned char* is_clear);

/// The sum of the values of simple pixels. Arrays of kBatch; nothing is simple behind the last one.
float sum_simple(const float* values, const unsigned char* is_simple);

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

inline constexpr int kMostCells = 16;  ///< per axis

/// What of a refined pixel the corners of cells that are not smooth stand for: a quarter of each.
/// @param is_smooth  1 or 0, row by row
/// @param weight     of (n + 1)^2 corners
void corner_weights(const unsigned char* is_smooth, int cells_per_axis, float* weight);

}  // namespace glint::cut_kernels
