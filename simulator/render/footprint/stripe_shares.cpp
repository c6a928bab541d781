// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bright share of a footprint of any width. The phase over a pixel is the sum of two uniform
// variables, so the share is the square wave convolved with a trapezoid: the second difference of
// the wave's second integral, divided by both widths; where the footprint is narrower than the
// stripes the same is a sum over the edges in it. Widths are kept away from 0, where the quotient
// is 0 / 0. Own derivation: docs/theory/footprints.md, "What is integrated". Cost: four second
// integrals a footprint and frame, without branches; memory: the caller's rows.
#include "simulator/render/footprint/stripe_shares.h"

#include <cmath>

#include "core/simd.h"
#include "simulator/render/footprint/footprint_lane.h"

namespace glint::footprint_kernels {
namespace {

using footprint_lane::absolute;
using footprint_lane::kNarrow;
using footprint_lane::second_integral;
using footprint_lane::second_integral_shifted;
using footprint_lane::two_edge_rest;
using footprint_lane::Widths;
using footprint_lane::widths_of;

}  // namespace

GLINT_WIDE void half_widths(const float* __restrict gx,
                            const float* __restrict gy,
                            int count,
                            float* __restrict outer,
                            float* __restrict inner) {
  for (int i = 0; i < count; ++i) {
    const Widths widths = widths_of(gx[i], gy[i]);
    outer[i] = widths.outer();
    inner[i] = widths.inner();
  }
}

/// The trapezoid is the second difference of a second integral.
GLINT_WIDE void any_shares(const float* __restrict v,
                           const float* __restrict gx,
                           const float* __restrict gy,
                           int count,
                           double scale,
                           double duty,
                           float* __restrict shares) {
  constexpr double kNarrowest = 1e-4;
  for (int i = 0; i < count; ++i) {
    const double middle = scale * static_cast<double>(v[i]);
    const double x = scale * static_cast<double>(absolute(gx[i]));
    const double y = scale * static_cast<double>(absolute(gy[i]));
    const double a = x > kNarrowest ? x : kNarrowest;
    const double b = y > kNarrowest ? y : kNarrowest;
    const double outer = 0.5 * (a + b);
    const double inner = 0.5 * (a - b);
    const double difference =
        second_integral(middle + outer, duty) - second_integral(middle + inner, duty) -
        second_integral(middle - inner, duty) + second_integral(middle - outer, duty);
    shares[i] = static_cast<float>(duty + difference / (a * b));
  }
}

namespace {

/// Of one footprint, phases and widths already times the scale.
GLINT_INLINE float wide_share(float f, float duty, float outer, float inner) {
  constexpr float kNarrowest = 1e-3F;
  const float major = outer + inner;
  const float minor = outer - inner > kNarrowest ? outer - inner : kNarrowest;
  const float far = 0.5F * (major + minor);
  const float near = 0.5F * (major - minor);
  const float shifted = f + (1.0F - duty);
  const auto integral_at = [&](float moved) {
    return second_integral_shifted(shifted + moved, duty);
  };
  const float difference =
      (integral_at(far) - integral_at(near)) - (integral_at(-near) - integral_at(-far));
  return duty + difference / (major * minor);
}

struct WidthRange {
  float minimum;
  float maximum;
};

GLINT_WIDE WidthRange range_of_widths(const float* __restrict outer, int count) {
  WidthRange range = {.minimum = outer[0], .maximum = outer[0]};
  for (int i = 0; i < count; ++i) {
    range.minimum = outer[i] < range.minimum ? outer[i] : range.minimum;
    range.maximum = outer[i] > range.maximum ? outer[i] : range.maximum;
  }
  return range;
}

GLINT_WIDE void wide_shares(const float* __restrict v,
                            const float* __restrict outers,
                            const float* __restrict inners,
                            int count,
                            float scale,
                            float duty,
                            float* __restrict shares) {
  for (int i = 0; i < count; ++i) {
    const float moved = scale * v[i];
    shares[i] = wide_share(moved - std::floor(moved), duty, scale * outers[i], scale * inners[i]);
  }
}

/// Leaves wide footprints alone.
GLINT_WIDE void trapezoid_shares(const float* __restrict v,
                                 const float* __restrict outers,
                                 const float* __restrict inners,
                                 int count,
                                 float scale,
                                 float duty,
                                 float* __restrict shares) {
  const float limit = duty < 1.0F - duty ? duty : 1.0F - duty;
  const float narrowest = scale * kNarrow;
  for (int i = 0; i < count; ++i) {
    const float moved = scale * v[i];
    const float f = moved - std::floor(moved);
    const float outer = scale * outers[i];
    const float inner = scale * inners[i];
    const float major = outer + inner;
    const float minor = outer - inner > narrowest ? outer - inner : narrowest;
    const float per_major = 1.0F / major;
    const float trapezoid =
        0.5F + two_edge_rest(f, duty, outer, inner, per_major, 0.5F * per_major / minor);
    shares[i] = outer <= limit ? trapezoid : shares[i];
  }
}

}  // namespace

/// Footprints no wider than the stripes take the trapezoid, which does not cancel however small
/// they are; others the second difference of the second integral, taken near phase 0. Where all of
/// a chunk take the same, only that is computed.
void any_shares_fast(const float* v,
                     const float* outer,
                     const float* inner,
                     int count,
                     float scale,
                     float duty,
                     float* shares) {
  constexpr int kChunk = 64;
  constexpr float kRounding = 1e-6F;  // of the limit times the scale
  const float limit = (duty < 1.0F - duty ? duty : 1.0F - duty) / scale;
  for (int begin = 0; begin < count; begin += kChunk) {
    const int size = begin + kChunk < count ? kChunk : count - begin;
    const WidthRange widths = range_of_widths(outer + begin, size);
    if (widths.maximum > (1.0F - kRounding) * limit) {
      wide_shares(v + begin, outer + begin, inner + begin, size, scale, duty, shares + begin);
    }
    if (widths.minimum <= (1.0F + kRounding) * limit) {
      trapezoid_shares(v + begin, outer + begin, inner + begin, size, scale, duty, shares + begin);
    }
  }
}

}  // namespace glint::footprint_kernels
