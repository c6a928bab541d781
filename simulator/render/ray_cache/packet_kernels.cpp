// SPDX-License-Identifier: GPL-3.0-or-later
//
// The arithmetic on sixteen rays between two searches by Embree, in double: directions from the
// camera, planes of triangles, interpolated normals, mirror reflection, conversion to and from
// Embree's float. Each function is a loop over sixteen lanes without branches, which one source
// turns into vector code for several instruction sets, and a ray gets the same bits whatever rays
// stand beside it (docs/decisions/0002-bit-identical-results.md). Elementary geometry;
// docs/theory/tunnel.md, "What is kept". Memory: a packet of a few kB.
#include "simulator/render/ray_cache/packet_kernels.h"

#include <cmath>
#include <limits>

#include "core/simd.h"

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

GLINT_WIDE void row_points16(int x,
                             int y,
                             const double* __restrict offset_px,
                             double* __restrict x_px,
                             double* __restrict y_px) {
  const double y_of_all = static_cast<double>(y) + offset_px[1];
  for (int i = 0; i < kLanes; ++i) {
    x_px[i] = static_cast<double>(x + i) + offset_px[0];
    y_px[i] = y_of_all;
  }
}

namespace {

GLINT_INLINE void forget_hits(RayQuery* __restrict q) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    q->t_max[i] = std::numeric_limits<float>::infinity();
    q->triangle[i] = -1;
    q->geometry[i] = -1;
  }
}

}  // namespace

GLINT_WIDE void ask_from_point16(const double* __restrict origin_mm,
                                 const double* __restrict direction_x,
                                 const double* __restrict direction_y,
                                 const double* __restrict direction_z,
                                 int count,
                                 RayQuery& query) {
  RayQuery* __restrict q = &query;
  const auto x_mm = static_cast<float>(origin_mm[0]);
  const auto y_mm = static_cast<float>(origin_mm[1]);
  const auto z_mm = static_cast<float>(origin_mm[2]);
  for (std::size_t i = 0; i < kLanes; ++i) {
    q->origin_x[i] = x_mm;
    q->origin_y[i] = y_mm;
    q->origin_z[i] = z_mm;
    q->direction_x[i] = static_cast<float>(direction_x[i]);
    q->direction_y[i] = static_cast<float>(direction_y[i]);
    q->direction_z[i] = static_cast<float>(direction_z[i]);
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    q->valid[i] = static_cast<int>(i) < count ? -1 : 0;
  }
  forget_hits(q);
}

GLINT_WIDE void ask_reflected16(const IntersectionLanes& lanes,
                                const std::int32_t* __restrict triangle,
                                RayQuery& query) {
  const IntersectionLanes* __restrict l = &lanes;
  RayQuery* __restrict q = &query;
  for (std::size_t i = 0; i < kLanes; ++i) {
    q->origin_x[i] = static_cast<float>(l->start_x[i]);
    q->origin_y[i] = static_cast<float>(l->start_y[i]);
    q->origin_z[i] = static_cast<float>(l->start_z[i]);
    q->direction_x[i] = static_cast<float>(l->leaving_x[i]);
    q->direction_y[i] = static_cast<float>(l->leaving_y[i]);
    q->direction_z[i] = static_cast<float>(l->leaving_z[i]);
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    q->valid[i] = ((triangle[i] >= 0) & (l->rise[i] > 0.0)) ? -1 : 0;
  }
  forget_hits(q);
}

GLINT_WIDE bool take_hits16(const RayQuery& query, HitPacket& hits) {
  const RayQuery* __restrict q = &query;
  HitPacket* __restrict h = &hits;
  std::int32_t all = -1;  // misses are below zero, which a bit tells that only they all share
  for (std::size_t i = 0; i < kLanes; ++i) {
    h->t_mm[i] = q->t_max[i];
    h->triangle[i] = q->triangle[i];
    h->u[i] = q->u[i];
    h->v[i] = q->v[i];
    all &= q->triangle[i];
  }
  return all >= 0;
}

GLINT_WIDE std::int32_t common_triangle16(const HitPacket& hits) {
  const std::int32_t* __restrict triangle = hits.triangle.data();
  const std::int32_t first = triangle[0];
  std::int32_t differing = 0;
  for (int i = 0; i < kLanes; ++i) {
    differing |= triangle[i] ^ first;
  }
  return differing == 0 ? first : -1;
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
