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
