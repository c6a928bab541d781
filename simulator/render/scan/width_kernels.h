// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of the table T(w): how wide a pixel's stripes are, and values of the table.
#pragma once

#include "simulator/render/footprint/footprint_kernels.h"

namespace glint::footprint_kernels {

/// Rows of one quantity: the row itself and its neighbours.
struct ThreeRows {
  const float* above = nullptr;
  const float* here = nullptr;
  const float* below = nullptr;
};

/// When the phase counts as linear over the blur: its second difference over the blur's variance is
/// below `absolute` periods or below `relative` times the stripes' width w.
struct LinearPhase {
  float variance_px2 = 1.0F;
  float absolute = 0.0F;
  float relative = 0.0F;
};

/// w of T(w) for a row of pixels, and 1 where the phase is linear over the blur.
void stripe_widths(const ThreeRows& gx,
                   const ThreeRows& gy,
                   int count,
                   const LinearPhase& rule,
                   float* w,
                   unsigned char* is_linear);

/// values = mean + sum_k terms[k] cos((k + 1) angle), from the cosines of the angles.
void cosine_series(
    const double* terms, int size, double mean, const double* cosines, int count, double* values);

/// Differences of the phase to the neighbouring pixels, as phases_of_corners() has them.
/// @param scale  periods for each mm
void phase_differences(const CornerRows& corners, int count, float scale, float* gx, float* gy);

/// Tables of the same pieces, one of cubics and one that is straight between its nodes.
struct PieceTables {
  const float* coefficients = nullptr;  ///< four for each piece
  const float* nodes = nullptr;         ///< one more than pieces
  int pieces = 0;
  float per_unit = 0.0F;
};

/// A value of each table.
struct PieceValues {
  float cubic = 0.0F;
  float straight = 0.0F;
};

/// Values of both tables at w * per_unit where the mask is set, those of the last piece's end
/// beyond it, `other` elsewhere. Neighbours that share a piece or two, as they mostly do, cost no
/// gathering of coefficients.
void look_up_where(const unsigned char* mask,
                   const float* w,
                   int count,
                   const PieceTables& tables,
                   const PieceValues& other,
                   float* cubic,
                   float* straight);

/// Neighbours in a row that share a number.
inline constexpr int kRun = 32;

/// Adds to deviations, in squares, one of `more` for each run of pixels, where the mask is set.
/// @param has_any  whether any of the deviations is more than 0 there
void add_in_squares(
    const unsigned char* mask, const float* more, int count, bool has_any, float* deviation);

/// Multiplies values by one of `factors` for each run of pixels, where the mask is set.
void multiply_runs(const unsigned char* mask, const float* factors, int count, float* values);

}  // namespace glint::footprint_kernels
