// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of the table T(w): over its phases, and over a picture's pixels.
#pragma once

#include "simulator/render/footprint/footprint_kernels.h"

namespace glint::footprint_kernels {

/// values = mean + sum_k terms[k] cos((k + 1) angle), from the cosines of the angles.
void cosine_series(
    const double* terms, int size, double mean, const double* cosines, int count, double* values);

/// Differences of the phase to the neighbouring pixels, as phases_of_corners() has them.
/// @param scale  periods for each mm
void phase_slopes(const CornerRows& corners, int count, float scale, float* gx, float* gy);

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

}  // namespace glint::footprint_kernels
