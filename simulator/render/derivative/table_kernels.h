// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loop of the derivative of pixels whose mean is a table's, T(w) (scan_gradient.cpp).
#pragma once

#include <vector>

#include "simulator/render/footprint/footprint_kernels.h"

namespace glint::gradient_kernels {

/// A row of pixels whose value is a table's at w = sqrt(variance (gx^2 + gy^2)).
struct TableRow {
  const unsigned char* by_table = nullptr;  ///< 0: the pixel's value is no table's
  const float* derivative = nullptr;        ///< by the pixel
  const float* w = nullptr;
  footprint_kernels::CornerRows corners;  ///< of the coordinate of the stripes
  int count = 0;
  float scale = 1.0F;  ///< the variance, over the square of a period
};

/// Cubic pieces that begin at multiples of 1 / per_unit, the last one also beyond its end.
struct Pieces {
  const float* coefficients = nullptr;  ///< four for each, in powers of the place in it
  int count = 0;
  float per_unit = 1.0F;
};

/// Derivatives by gx and gy, in units of the corners' coordinate, for all pixels of the row: 0 for
/// those that are no table's.
/// @param by_w    the table's derivative by w
/// @param others  at most four other tables of as many pieces ...
/// @param sums    ... and for each, to which the sum of its values times the derivatives is added
/// @return the sum of by_gx gx + by_gy gy
double table_gradient(const TableRow& row,
                      const Pieces& by_w,
                      const std::vector<const float*>& others,
                      double* sums,
                      float* by_gx,
                      float* by_gy);

}  // namespace glint::gradient_kernels
