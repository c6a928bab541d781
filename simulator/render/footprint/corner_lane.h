// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a single lane of the kernels does that work on pixels by their corners. Always inlined, so
// that each kernel is compiled for its own instruction set.
#pragma once

#include "core/simd.h"
#include "simulator/render/footprint/cut_kernels.h"

namespace glint::corner_lane {

GLINT_INLINE float smaller(float a, float b) {
  return a < b ? a : b;
}

GLINT_INLINE float larger(float a, float b) {
  return a < b ? b : a;
}

/// Least squares through four corners.
struct Linear {
  double value, dx, dy;
};

GLINT_INLINE Linear linear_at(const cut_kernels::Corners& corners, int i) {
  const auto a = static_cast<double>(corners.at[0][i]);
  const auto b = static_cast<double>(corners.at[1][i]);
  const auto c = static_cast<double>(corners.at[2][i]);
  const auto d = static_cast<double>(corners.at[3][i]);
  return {0.25 * (a + b + c + d), 0.5 * (b + d - a - c), 0.5 * (c + d - a - b)};
}

}  // namespace glint::corner_lane
