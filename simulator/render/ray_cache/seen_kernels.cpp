// SPDX-License-Identifier: GPL-3.0-or-later
//
// Means over the rays of a pixel: sums of what was seen, divided by how many rays saw it. Rays that
// missed are multiplied by 0 and not jumped over, so that a row is one pass in wide instructions
// and the order of additions is fixed (docs/decisions/0002-bit-identical-results.md). Some ten
// operations a ray. docs/theory/tunnel.md, "What is kept".
#include "simulator/render/ray_cache/seen_kernels.h"

#include "core/simd.h"
#include "simulator/geometry/bvh/ray_packet.h"

namespace glint {
namespace {

constexpr int kLanes = kPacketSize;

GLINT_INLINE void add_products(const double* __restrict a,
                               const double* __restrict b,
                               int count,
                               double* __restrict sum) {
  for (int i = 0; i < count; ++i) {
    sum[i] += a[i] * b[i];
  }
}

GLINT_INLINE void add(const double* __restrict a, int count, double* __restrict sum) {
  for (int i = 0; i < count; ++i) {
    sum[i] += a[i];
  }
}

}  // namespace

/// Products instead of choices: the compiler would branch around the loads and not vectorise.
GLINT_WIDE void add_seen(const double* x_mm,
                         const double* y_mm,
                         const double* z_mm,
                         const double* is_seen,
                         int count,
                         const SeenSums& sums) {
  const SeenSums to = sums;
  if (count == kLanes) {
    add_products(is_seen, x_mm, kLanes, to.x_mm);
    add_products(is_seen, y_mm, kLanes, to.y_mm);
    add_products(is_seen, z_mm, kLanes, to.z_mm);
    add(is_seen, kLanes, to.hits);
    return;
  }
  add_products(is_seen, x_mm, count, to.x_mm);
  add_products(is_seen, y_mm, count, to.y_mm);
  add_products(is_seen, z_mm, count, to.z_mm);
  add(is_seen, count, to.hits);
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

namespace {

GLINT_INLINE void round_seen(const double* __restrict from,
                             const double* __restrict is_seen,
                             int count,
                             float* __restrict to) {
  for (int i = 0; i < count; ++i) {
    to[i] = static_cast<float>(is_seen[i] * from[i] + 0.0);  // no negative zeros
  }
}

GLINT_INLINE void round_all(const double* __restrict from, int count, float* __restrict to) {
  for (int i = 0; i < count; ++i) {
    to[i] = static_cast<float>(from[i]);
  }
}

}  // namespace

GLINT_WIDE void one_seen(const double* from_x_mm,
                         const double* from_y_mm,
                         const double* from_z_mm,
                         const double* is_seen,
                         int count,
                         float* coverage,
                         float* x_mm,
                         float* y_mm,
                         float* z_mm) {
  const int used = count == kLanes ? kLanes : count;
  round_all(is_seen, used, coverage);
  round_seen(from_x_mm, is_seen, used, x_mm);
  round_seen(from_y_mm, is_seen, used, y_mm);
  round_seen(from_z_mm, is_seen, used, z_mm);
}

}  // namespace glint
