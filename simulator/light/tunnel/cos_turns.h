// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/simd.h"

#include <cmath>

namespace glint {

/// cos(2 pi x) to 1e-6 for any x of moderate size.
GLINT_INLINE float cos_turns(float x) {
  const float turn = x - std::floor(x + 0.5F);  // [-0.5, 0.5)
  const float a = turn < 0.0F ? -turn : turn;
  const float folded = a > 0.25F ? 0.5F - a : a;
  const float sign = a > 0.25F ? -1.0F : 1.0F;
  const float p = folded * 6.2831853F;
  const float p2 = p * p;
  return sign *
         (1.0F + p2 * (-0.5F + p2 * (0.041666667F + p2 * (-0.0013888889F + p2 * 2.4801587e-5F))));
}

}  // namespace glint
