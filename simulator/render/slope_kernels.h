// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of the derivative of a scan, the counterparts of footprint_kernels.h: what each
// quantity of a footprint changes, summed over the frames with a weight for each.
#pragma once

#include <cstddef>

#include "simulator/render/footprint_kernels.h"

namespace glint::slope_kernels {

/// Sums over frames, one value a pixel; all arrays as long as the row.
struct BoxSlopes {
  float* v = nullptr;   ///< by the phase
  float* gx = nullptr;  ///< by |gx|, |gy|: see box_slopes
  float* gy = nullptr;
  float* duty = nullptr;
  float* share = nullptr;   ///< sum of weight * bright share
  float* weight = nullptr;  ///< sum of weights
};

/// Adds weight * d(bright share) for a frame. Slopes by gx and gy are those by the larger and the
/// smaller of |gx|, |gy|, put where they belong, with the sign of gx and gy.
void add_box_slopes(const float* v,
                    const float* gx,
                    const float* gy,
                    const float* weight,
                    int count,
                    float shift,
                    float duty,
                    const BoxSlopes& out);

/// The same, but for rounding, for footprints that all are narrow (footprint_kernels.h) where their
/// weight is not 0: one edge at most is near.
void add_narrow_slopes(const float* v,
                       const float* gx,
                       const float* gy,
                       const float* weight,
                       int count,
                       float shift,
                       float duty,
                       const BoxSlopes& out);

/// out = a * b
void multiply(const float* a, const float* b, int count, float* out);

/// In double, lane by lane: the same bits for any instruction set.
double exact_sum(const float* values, std::size_t count);

/// to += factor * from
void add_scaled(const float* from, int count, float factor, float* to);

/// The slope of min(1, linear * radiance).
void unclipped_slopes(const float* radiance, int count, float linear, float* slopes);

/// by *= by_aspect * factor. @return the sum of by * grey
double weigh_slopes(const float* by_aspect, const float* grey, int count, float factor, float* by);

/// A table of cubic pieces, as look_up() of footprint_kernels.h takes it.
struct Pieces {
  const float* coefficients = nullptr;
  int count = 0;
  float per_unit = 1.0F;
};

/// weight[i] * table(w[i]), summed.
double weighted_look_up(const float* w, const float* weight, int count, const Pieces& table);

/// Slopes by gx and gy of pixels whose value is a table's at w = sqrt(variance (gx^2 + gy^2)).
/// @param slope  the table's derivative by w
/// @return the sum of by_gx gx + by_gy gy
double width_slopes(const float* w,
                    const float* gx,
                    const float* gy,
                    const float* weight,
                    int count,
                    const Pieces& slope,
                    float variance_px2,
                    float* by_gx,
                    float* by_gy);

/// Slopes by gx and gy of a row of pixels to those by its corners, times `half`.
void add_to_corners(
    const float* by_gx, const float* by_gy, int count, float half, float* top, float* bottom);

/// Weighted sums over frames at a vertex: of the square wave less its mean, its first and second
/// integral, and the second integral's derivative by the duty.
struct VertexSums {
  double wave = 0.0;
  double first = 0.0;
  double second = 0.0;
  double first_by_duty = 0.0;
  double second_by_duty = 0.0;
};

VertexSums weigh_vertex(
    double phase, const double* shift, const double* weight, int frames, double duty);

}  // namespace glint::slope_kernels
