// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/wall/revolved_kernels.h"

#include <cmath>

#include "core/simd.h"

namespace glint::revolved_kernels {

GLINT_WIDE void revolve(const PlainBlock& rays,
                        int count,
                        double base_mm,
                        float* __restrict a_mm,
                        float* __restrict m,
                        float* __restrict h_mm,
                        float* __restrict ey,
                        float* __restrict ez) {
  const float* __restrict ox = rays.origin_x;
  const float* __restrict oy = rays.origin_y;
  const float* __restrict oz = rays.origin_z;
  const float* __restrict dx = rays.direction_x;
  const float* __restrict dy = rays.direction_y;
  const float* __restrict dz = rays.direction_z;
  for (int i = 0; i < count; ++i) {
    const auto along_y = static_cast<double>(dy[i]);
    const auto along_z = static_cast<double>(dz[i]);
    const auto from_y = static_cast<double>(oy[i]);
    const double from_z = static_cast<double>(oz[i]) - base_mm;
    const double length = std::sqrt(along_y * along_y + along_z * along_z);
    const double per_length = length > 0.0 ? 1.0 / length : 0.0;
    const double unit_y = along_y * per_length;
    const double unit_z = along_z * per_length;
    const double slope = static_cast<double>(dx[i]) * per_length;
    const double from_foot = from_y * unit_y + from_z * unit_z;
    a_mm[i] = static_cast<float>(static_cast<double>(ox[i]) - slope * from_foot);
    m[i] = static_cast<float>(slope);
    h_mm[i] = static_cast<float>(from_y * unit_z - from_z * unit_y);
    ey[i] = static_cast<float>(unit_y);
    ez[i] = static_cast<float>(unit_z);
  }
}

GLINT_WIDE void meet_revolved(const RevolvedBlock& rays,
                              int count,
                              float radius_mm,
                              float nowhere,
                              float* __restrict x_mm,
                              float* __restrict y_mm,
                              float* __restrict z_mm) {
  const float* __restrict a = rays.a_mm;
  const float* __restrict m = rays.m;
  const float* __restrict h = rays.h_mm;
  const float* __restrict ey = rays.ey;
  const float* __restrict ez = rays.ez;
  const float squared_radius = radius_mm * radius_mm;
  for (int i = 0; i < count; ++i) {
    const float left = squared_radius - h[i] * h[i];
    const bool is_met = (left > 0.0F) & (ey[i] * ey[i] + ez[i] * ez[i] > 0.0F);
    const float s = std::sqrt(left > 0.0F ? left : 0.0F);
    x_mm[i] = a[i] + m[i] * s;
    y_mm[i] = h[i] * ez[i] + s * ey[i];
    z_mm[i] = is_met ? s * ez[i] - h[i] * ey[i] : nowhere;
  }
}

}  // namespace glint::revolved_kernels
