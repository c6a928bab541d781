// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of the derivative of a scan, the counterparts of
// simulator/render/footprint/footprint_kernels.h: what each quantity of a footprint changes, summed
// over the frames with a weight for each.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "simulator/render/footprint/footprint_kernels.h"

namespace glint::gradient_kernels {

/// A phase in units of 2^-32 periods. Whole periods wrap by themselves, and the difference of two
/// is exact: in float, places of edges err by 6e-8 periods, which a narrow footprint sees as a
/// change of its derivative that the frames on both sides of an edge do not share.
using FixedPhase = std::uint32_t;

inline FixedPhase fixed_phase_of(double periods) {
  constexpr double kTurns = 4294967296.0;
  return static_cast<FixedPhase>(
      static_cast<std::uint64_t>((periods - std::floor(periods)) * kTurns));
}

/// Sums over frames, one value a pixel; all arrays as long as the row.
struct BoxGradients {
  float* v = nullptr;   ///< by the phase
  float* gx = nullptr;  ///< by |gx|, |gy|: see box_gradients
  float* gy = nullptr;
  float* duty = nullptr;
  float* dark = nullptr;  ///< sum of weight * (1 - bright share)
};

/// Adds weight * d(bright share) for a frame. Derivatives by gx and gy are those by the larger and
/// the smaller of |gx|, |gy|, put where they belong, with the sign of gx and gy.
void add_box_gradients(const FixedPhase* v,
                       const float* gx,
                       const float* gy,
                       const float* weight,
                       int count,
                       double shift,
                       double duty,
                       const BoxGradients& out);

/// The same, summed.
struct BoxSums {
  double v = 0.0;
  double gx = 0.0;
  double gy = 0.0;
  double duty = 0.0;
  double dark = 0.0;
};

/// In double. @param count  a multiple of 8
BoxSums totals_of(const BoxGradients& gradient, int count);

/// A row's phases and their derivatives [periods].
struct ExactPhases {
  double* phase = nullptr;
  FixedPhase* v = nullptr;  ///< the same less whole periods
  float* gx = nullptr;
  float* gy = nullptr;
};

/// As footprint_kernels::phases_of_corners(), in double: the derivatives of frames on both sides of
/// an edge cancel, and a phase many periods away would leave a float too few digits for the rest.
void exact_phases(const footprint_kernels::CornerRows& corners,
                  int count,
                  double offset_mm,
                  double per_period,
                  const ExactPhases& out);

/// What a footprint needs in every frame.
struct BoxShapes {
  float* outer = nullptr;  ///< half of |gx| + |gy|: no edge beyond is seen
  float* inner = nullptr;  ///< half of their difference
  float* per_major = nullptr;
  float* per_minor = nullptr;
  float* flatness = nullptr;  ///< half of the smaller over the larger
};

void box_shapes(const float* gx, const float* gy, int count, const BoxShapes& shapes);

/// Sums over frames by the edge that is near, without the factors that all frames share.
struct NarrowSums {
  float* rising = nullptr;
  float* falling = nullptr;
  float* major = nullptr;  ///< by the larger of |gx|, |gy|
  float* minor = nullptr;
  float* dark = nullptr;
};

/// Adds a frame for footprints that all are narrow (simulator/render/footprint/footprint_kernels.h)
/// where their weight is not 0: one edge at most is near.
void add_narrow_frame(const FixedPhase* v,
                      const BoxShapes& shapes,
                      const float* weight,
                      int count,
                      double shift,
                      double duty,
                      const NarrowSums& sums);

/// Adds what add_box_gradients() would have added, but for rounding, in all these frames.
void add_narrow_sums(const float* gx,
                     const float* gy,
                     const BoxShapes& shapes,
                     const NarrowSums& sums,
                     int count,
                     const BoxGradients& out);

/// out = a * b
void multiply(const float* a, const float* b, int count, float* out);

/// to *= by
void multiply_by(const float* by, int count, float* to);

/// In double, lane by lane: the same bits for any instruction set.
double exact_sum(const float* values, std::size_t count);

/// The same of a * b.
double exact_dot(const float* a, const float* b, std::size_t count);
double exact_dot(const float* a, const double* b, std::size_t count);

/// to += factor * from
void add_scaled(const float* from, int count, float factor, float* to);

/// 1 where linear * radiance does not clip, else 0.
void mark_unclipped(const float* radiance, int count, float linear, float* marks);

/// Derivatives by gx and gy of a row of pixels to those by its corners. Before and after the row's
/// there must be a 0.
void add_gradients_to_corners(
    const float* by_gx, const float* by_gy, int count, float* top, float* bottom);

/// The same for derivatives by the mean of the corners.
void add_means_to_corners(const float* by_v, int count, float* top, float* bottom);

}  // namespace glint::gradient_kernels
