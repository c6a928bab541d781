// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of the fringes' phase (phase.h): a sum of weighted frames, which is the discrete
// Fourier transform at the fringe frequency frame by frame, and a convolution along a row. Each is
// one multiplication and one addition a pixel and frame, or a pixel and tap, bound by memory;
// written so that the compiler makes wide instructions of them. docs/theory/inspection.md.
#include "metrics/inspection/phase_kernels.h"

#include <algorithm>

#include "core/simd.h"

namespace glint {

GLINT_WIDE void add_scaled(const float* __restrict from,
                           float weight,
                           float* __restrict to,
                           int count) {
  for (int i = 0; i < count; ++i) {
    to[i] += weight * from[i];
  }
}

void convolve_along(const float* from, const float* weights, int taps, float* to, int count) {
  std::fill_n(to, count, 0.0F);
  for (int k = 0; k < taps; ++k) {
    add_scaled(from + k, weights[k], to, count);
  }
}

}  // namespace glint
