// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint {

/// to[i] += weight * from[i]; the arrays do not overlap.
void add_scaled(const float* from, float weight, float* to, int count);

/// to[i] = sum of weights[k] * from[i + k]; from has count + taps - 1 values.
void convolve_along(const float* from, const float* weights, int taps, float* to, int count);

}  // namespace glint
