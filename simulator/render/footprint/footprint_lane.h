// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a single lane of the kernels does that work on footprints. Always inlined, so that each
// kernel is compiled for its own instruction set.
#pragma once

#include <cmath>

#include "core/simd.h"

namespace glint::footprint_lane {

/// Footprints narrower than this (in periods) are taken as this wide.
inline constexpr float kNarrow = 1e-6F;

template <class Real>
GLINT_INLINE Real absolute(Real x) {
  return std::fabs(x);
}

/// Sizes of a footprint's two differences [periods a pixel], at least kNarrow.
struct Widths {
  float major = 0.0F;
  float minor = 0.0F;

  /// Half widths of its trapezoid, outer and inner.
  float outer() const { return 0.5F * (major + minor); }

  float inner() const { return 0.5F * (major - minor); }
};

GLINT_INLINE Widths widths_of(float gx, float gy) {
  const float a = absolute(gx);
  const float b = absolute(gy);
  const float large = a < b ? b : a;
  const float small = a < b ? a : b;
  return {.major = large > kNarrow ? large : kNarrow, .minor = small > kNarrow ? small : kNarrow};
}

struct Range {
  float low;
  float high;
};

/// Of the four corners of pixel or cell i.
GLINT_INLINE Range range_of(const float* top, const float* bottom, int i) {
  const float a = top[i] < bottom[i] ? top[i] : bottom[i];
  const float b = top[i + 1] < bottom[i + 1] ? top[i + 1] : bottom[i + 1];
  const float c = top[i] < bottom[i] ? bottom[i] : top[i];
  const float d = top[i + 1] < bottom[i + 1] ? bottom[i + 1] : top[i + 1];
  return {a < b ? a : b, c < d ? d : c};
}

/// Share of a trapezoid beyond 0 at distance d from its middle, less one half; odd in d.
GLINT_INLINE float beyond(float d, float outer, float inner, float per_major, float per_both) {
  const float size = absolute(d);
  const float t = size < outer ? size : outer;
  const float over = t > inner ? t - inner : 0.0F;
  return std::copysign(t * per_major - over * over * per_both, d);
}

/// The bright share less one half where at most one edge is near: folded around the middle of the
/// bright stripe.
GLINT_INLINE float one_edge_rest(
    float from_middle, float half_duty, float outer, float inner, float per_major, float per_both) {
  const float turn = from_middle - std::floor(from_middle + 0.5F);
  return beyond(half_duty - absolute(turn), outer, inner, per_major, per_both);
}

/// The same where both edges of a stripe may be near.
GLINT_INLINE float two_edge_rest(
    float moved, float duty, float outer, float inner, float per_major, float per_both) {
  const float f = moved - std::floor(moved);
  const float rise = beyond(f, outer, inner, per_major, per_both);
  const float fall = beyond(f - duty, outer, inner, per_major, per_both);
  const float next = beyond(f - 1.0F, outer, inner, per_major, per_both);
  // The ends of the stripes before and after: exactly 1/2 and -1/2 unless a stripe, or the gap
  // between two, is thinner than the footprint.
  const float fall_before = beyond(f - duty + 1.0F, outer, inner, per_major, per_both);
  const float fall_after = beyond(f - duty - 1.0F, outer, inner, per_major, per_both);
  return rise - fall + next - (fall_before + fall_after);
}

/// I: the first integral of the square wave less its mean, periodic and of mean zero.
template <class Real>
GLINT_INLINE Real first_integral(Real phase, Real duty) {
  constexpr auto kOne = static_cast<Real>(1.0);
  const Real rest = kOne - duty;
  const Real f = phase - std::floor(phase);
  const Real up = rest * f;
  const Real down = duty * (kOne - f);
  return (up < down ? up : down) - static_cast<Real>(0.5) * duty * rest;
}

/// J: the second integral, periodic and 0 at whole phases.
/// @param shifted  the phase and the rest 1 - duty
template <class Real>
GLINT_INLINE Real second_integral_shifted(Real shifted, Real duty) {
  constexpr auto kHalf = static_cast<Real>(0.5);
  const Real rest = static_cast<Real>(1.0) - duty;
  // From the nearest whole phase: bright ahead of it, dark behind it.
  const Real t = (shifted - std::floor(shifted)) - rest;
  const Real ahead = kHalf * rest * t;
  const Real behind = -kHalf * duty * t;
  return t * ((ahead > behind ? ahead : behind) - kHalf * duty * rest);
}

/// The same at a phase.
template <class Real>
GLINT_INLINE Real second_integral(Real phase, Real duty) {
  return second_integral_shifted(phase + (static_cast<Real>(1.0) - duty), duty);
}

}  // namespace glint::footprint_lane
