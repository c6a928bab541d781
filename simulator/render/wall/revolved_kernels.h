// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of revolved_rays.h, free of Eigen so that they can be compiled for wide instruction
// sets.
#pragma once

namespace glint::revolved_kernels {

/// Rays as they are traced.
struct PlainBlock {
  const float* origin_x = nullptr;
  const float* origin_y = nullptr;
  const float* origin_z = nullptr;
  const float* direction_x = nullptr;
  const float* direction_y = nullptr;
  const float* direction_z = nullptr;
};

/// The numbers of RevolvedRays, in double until they are stored.
void revolve(const PlainBlock& rays,
             int count,
             double base_mm,
             float* a_mm,
             float* m,
             float* h_mm,
             float* ey,
             float* ez);

/// Rays of revolved_rays.h.
struct RevolvedBlock {
  const float* a_mm = nullptr;
  const float* m = nullptr;
  const float* h_mm = nullptr;
  const float* ey = nullptr;
  const float* ez = nullptr;
};

/// Where they meet a cylinder; z counts from its axis and is `nowhere` for rays that do not.
void meet_revolved(const RevolvedBlock& rays,
                   int count,
                   float radius_mm,
                   float nowhere,
                   float* x_mm,
                   float* y_mm,
                   float* z_mm);

}  // namespace glint::revolved_kernels
