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

/// value + x dx + y dy over each pixel, x and y from -1/2 to 1/2.
struct LinearBatch {
  alignas(64) double value[kBatch], dx[kBatch], dy[kBatch];
};

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

/// The sum of the values of simple pixels. Arrays of kBatch; nothing is simple behind the last one.
float sum_simple(const float* values, const unsigned char* is_simple);

}  // namespace glint::cut_kernels
