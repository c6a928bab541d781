// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where rays meet a chain of cubic segments: an inner loop like those of tunnel_kernels.h.
#pragma once

#include "simulator/light/tunnel/tunnel_kernels.h"

namespace glint {

/// A cubic piece of the free cross-section: y(u), z(u) in powers of u in [0, 1].
struct SplineSegment {
  double y[4] = {0, 0, 0, 0};
  double z[4] = {0, 0, 0, 0};
};

/// A chain of cubic segments; the nearest crossing in front of the ray.
void hit_spline(const RayBlock& rays, const SplineSegment* segments, int num_segments, float* t_mm);

}  // namespace glint
