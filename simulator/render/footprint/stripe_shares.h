// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bright share of footprints of any width: kernels as those of footprint_kernels.h.
#pragma once

namespace glint::footprint_kernels {

/// Bright share of footprints of any width, phase and differences times `scale`.
void any_shares(const float* v,
                const float* gx,
                const float* gy,
                int count,
                double scale,
                double duty,
                float* shares);

/// Half widths of each footprint's trapezoid (Trapezoids).
void half_widths(const float* gx, const float* gy, int count, float* outer, float* inner);

/// The same in float, for half widths and phases that are `scale` times v's: wrong by up to 1e-3
/// where a footprint wider than the stripes is almost a line.
void any_shares_fast(const float* v,
                     const float* outer,
                     const float* inner,
                     int count,
                     float scale,
                     float duty,
                     float* shares);

}  // namespace glint::footprint_kernels
