// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/packet_kernels.h"

#include <cmath>

#define GLINT_WIDE __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))

namespace glint {

GLINT_WIDE void camera_directions16(const PinholeNumbers& camera,
                                    const double* __restrict x_px,
                                    const double* __restrict y_px,
                                    double* __restrict direction_x,
                                    double* __restrict direction_y,
                                    double* __restrict direction_z) {
  const PinholeNumbers c = camera;
  const double* r = c.rotation;
  const double per_focal_x = 1.0 / c.focal_x_px;
  const double per_focal_y = 1.0 / c.focal_y_px;
  for (int i = 0; i < kLanes; ++i) {
    const double x = (x_px[i] - c.center_x_px) * per_focal_x;
    const double y = (y_px[i] - c.center_y_px) * per_focal_y;
    const double uz = 1.0 / std::sqrt(x * x + (y * y + 1.0));
    const double ux = x * uz;
    const double uy = y * uz;
    direction_x[i] = r[0] * ux + (r[1] * uy + r[2] * uz);
    direction_y[i] = r[3] * ux + (r[4] * uy + r[5] * uz);
    direction_z[i] = r[6] * ux + (r[7] * uy + r[8] * uz);
  }
}

GLINT_WIDE void meet_planes16(const double* origin_mm, MeetingLanes& lanes) {
  const double ox = origin_mm[0];
  const double oy = origin_mm[1];
  const double oz = origin_mm[2];
  MeetingLanes* __restrict l = &lanes;
  for (int i = 0; i < kLanes; ++i) {
    const double slope = l->face_x[i] * l->direction_x[i] +
                         (l->face_y[i] * l->direction_y[i] + l->face_z[i] * l->direction_z[i]);
    const double height =
        l->offset_mm[i] - (l->face_x[i] * ox + (l->face_y[i] * oy + l->face_z[i] * oz));
    l->slope[i] = slope;
    l->t_mm[i] = height / slope;
  }
}

GLINT_WIDE void orient16(MeetingLanes& lanes) {
  MeetingLanes* __restrict l = &lanes;
  for (int i = 0; i < kLanes; ++i) {
    const double dx = l->direction_x[i];
    const double dy = l->direction_y[i];
    const double dz = l->direction_z[i];
    const double side = l->slope[i] > 0.0 ? -1.0 : 1.0;
    const double fx = side * l->face_x[i];
    const double fy = side * l->face_y[i];
    const double fz = side * l->face_z[i];
    const double nx = side * l->normal_x[i];
    const double ny = side * l->normal_y[i];
    const double nz = side * l->normal_z[i];
    const bool is_towards = nx * dx + (ny * dy + nz * dz) < 0.0;
    l->face_x[i] = fx;
    l->face_y[i] = fy;
    l->face_z[i] = fz;
    l->normal_x[i] = is_towards ? nx : fx;
    l->normal_y[i] = is_towards ? ny : fy;
    l->normal_z[i] = is_towards ? nz : fz;
  }
}

GLINT_WIDE void reflect16(const double* origin_mm, double lift_mm, MeetingLanes& lanes) {
  const double ox = origin_mm[0];
  const double oy = origin_mm[1];
  const double oz = origin_mm[2];
  MeetingLanes* __restrict l = &lanes;
  for (int i = 0; i < kLanes; ++i) {
    const double dx = l->direction_x[i];
    const double dy = l->direction_y[i];
    const double dz = l->direction_z[i];
    const double nx = l->normal_x[i];
    const double ny = l->normal_y[i];
    const double nz = l->normal_z[i];
    const double twice = 2.0 * (dx * nx + (dy * ny + dz * nz));
    const double rx = dx - twice * nx;
    const double ry = dy - twice * ny;
    const double rz = dz - twice * nz;
    // Unit but for rounding: one step towards 1 / length is exact.
    const double scale = 1.5 - 0.5 * (rx * rx + (ry * ry + rz * rz));
    l->leaving_x[i] = rx * scale;
    l->leaving_y[i] = ry * scale;
    l->leaving_z[i] = rz * scale;
    l->rise[i] = rx * l->face_x[i] + (ry * l->face_y[i] + rz * l->face_z[i]);
    l->start_x[i] = ox + l->t_mm[i] * dx + lift_mm * l->face_x[i];
    l->start_y[i] = oy + l->t_mm[i] * dy + lift_mm * l->face_y[i];
    l->start_z[i] = oz + l->t_mm[i] * dz + lift_mm * l->face_z[i];
  }
}

GLINT_WIDE void add_seen(const double* __restrict x_mm,
                         const double* __restrict y_mm,
                         const double* __restrict z_mm,
                         const double* __restrict is_seen,
                         int count,
                         const SeenSums& sums) {
  double* __restrict hits = sums.hits;
  double* __restrict sum_x = sums.x_mm;
  double* __restrict sum_y = sums.y_mm;
  double* __restrict sum_z = sums.z_mm;
  for (int i = 0; i < count; ++i) {
    const bool is_hit = is_seen[i] != 0.0;
    hits[i] += is_seen[i];
    sum_x[i] += is_hit ? x_mm[i] : 0.0;
    sum_y[i] += is_hit ? y_mm[i] : 0.0;
    sum_z[i] += is_hit ? z_mm[i] : 0.0;
  }
}

GLINT_WIDE void mean_seen(const SeenSums& sums,
                          int samples,
                          int count,
                          float* __restrict coverage,
                          float* __restrict x_mm,
                          float* __restrict y_mm,
                          float* __restrict z_mm) {
  const double* __restrict hits = sums.hits;
  const double* __restrict sum_x = sums.x_mm;
  const double* __restrict sum_y = sums.y_mm;
  const double* __restrict sum_z = sums.z_mm;
  const auto all = static_cast<float>(samples);
  for (int i = 0; i < count; ++i) {
    const double divisor = hits[i] > 0.0 ? hits[i] : 1.0;
    coverage[i] = static_cast<float>(hits[i]) / all;
    x_mm[i] = static_cast<float>(sum_x[i] / divisor);
    y_mm[i] = static_cast<float>(sum_y[i] / divisor);
    z_mm[i] = static_cast<float>(sum_z[i] / divisor);
  }
}

GLINT_WIDE bool is_any_inside16(const double* __restrict x_mm,
                                const double* __restrict y_mm,
                                const double* __restrict z_mm,
                                const double* __restrict box_mm) {
  std::int64_t inside = 0;
  for (int i = 0; i < kLanes; ++i) {
    const bool is_in_x = (x_mm[i] >= box_mm[0]) & (x_mm[i] <= box_mm[3]);
    const bool is_in_y = (y_mm[i] >= box_mm[1]) & (y_mm[i] <= box_mm[4]);
    const bool is_in_z = (z_mm[i] >= box_mm[2]) & (z_mm[i] <= box_mm[5]);
    inside |= (is_in_x & is_in_y & is_in_z) ? 1 : 0;
  }
  return inside != 0;
}

GLINT_WIDE void to_float(const double* const* in, int count, float* const* out) {
  for (int k = 0; k < 3; ++k) {
    const double* __restrict from = in[k];
    float* __restrict to = out[k];
    if (count == kLanes) {
      for (int i = 0; i < kLanes; ++i) {
        to[i] = static_cast<float>(from[i]);
      }
      continue;
    }
    for (int i = 0; i < count; ++i) {
      to[i] = static_cast<float>(from[i]);
    }
  }
}

}  // namespace glint
