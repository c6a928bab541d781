// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of structure_similarity.cpp, compiled for wide instruction sets.
#pragma once

namespace glint::ssim_kernels {

inline constexpr int kTaps = 11;

/// Rows of the five weighted sums a, b, aa, bb, ab over kTaps rows of both pictures.
struct Sums {
  float* a;
  float* b;
  float* aa;
  float* bb;
  float* ab;
};

/// sums[x] = sum over k of weights[k] (a, b, a a, b b, a b) of rows k at x
void sum_rows(const float* const* rows_a,
              const float* const* rows_b,
              const float* weights,
              int width,
              const Sums& sums);

/// out[x] = sum over k of weights[k] row[x + k]; row has width + kTaps - 1 values
void sum_columns(const float* row, const float* weights, int width, float* out);

/// ssim[x] of windowed means.
void compare(const Sums& means, float c1, float c2, int width, float* ssim);

}  // namespace glint::ssim_kernels
