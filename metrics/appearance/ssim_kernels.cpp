// SPDX-License-Identifier: GPL-3.0-or-later
//
// Structural similarity row by row: 11 rows are summed at once, then 11 columns of the sums, so
// that everything stays in the first cache. Cost: some 150 operations a pixel, linear in the
// pixels. Source: Wang et al. 2004 (structure_similarity.h, docs/theory/comparison.md).
#include "metrics/appearance/ssim_kernels.h"

#include "core/simd.h"

namespace glint::ssim_kernels {

GLINT_WIDE void sum_rows(const float* const* rows_a,
                         const float* const* rows_b,
                         const float* weights,
                         int width,
                         const Sums& sums) {
  float* __restrict sum_a = sums.a;
  float* __restrict sum_b = sums.b;
  float* __restrict sum_aa = sums.aa;
  float* __restrict sum_bb = sums.bb;
  float* __restrict sum_ab = sums.ab;
  for (int x = 0; x < width; ++x) {
    float a = 0.0F;
    float b = 0.0F;
    float aa = 0.0F;
    float bb = 0.0F;
    float ab = 0.0F;
    for (int k = 0; k < kTaps; ++k) {
      const float p = rows_a[k][x];
      const float q = rows_b[k][x];
      const float wp = weights[k] * p;
      const float wq = weights[k] * q;
      a += wp;
      b += wq;
      aa += wp * p;
      bb += wq * q;
      ab += wp * q;
    }
    sum_a[x] = a;
    sum_b[x] = b;
    sum_aa[x] = aa;
    sum_bb[x] = bb;
    sum_ab[x] = ab;
  }
}

GLINT_WIDE void sum_columns(const float* row, const float* weights, int width, float* out) {
  float* __restrict sums = out;
  for (int x = 0; x < width; ++x) {
    float sum = 0.0F;
    for (int k = 0; k < kTaps; ++k) {
      sum += weights[k] * row[x + k];
    }
    sums[x] = sum;
  }
}

GLINT_WIDE void compare(const Sums& means, float c1, float c2, int width, float* ssim) {
  const float* __restrict a = means.a;
  const float* __restrict b = means.b;
  const float* __restrict aa = means.aa;
  const float* __restrict bb = means.bb;
  const float* __restrict ab = means.ab;
  float* __restrict out = ssim;
  for (int x = 0; x < width; ++x) {
    const float both = a[x] * b[x];
    const float squares = a[x] * a[x] + b[x] * b[x];
    const float covariance = ab[x] - both;
    const float variances = aa[x] + bb[x] - squares;
    out[x] = (2.0F * both + c1) * (2.0F * covariance + c2) / ((squares + c1) * (variances + c2));
  }
}

}  // namespace glint::ssim_kernels
