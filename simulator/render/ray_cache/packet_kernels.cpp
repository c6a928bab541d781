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

GLINT_WIDE bool meet_planes16(double flat, MeetingLanes& lanes) {
  MeetingLanes* __restrict l = &lanes;
  for (int i = 0; i < kLanes; ++i) {
    const double slope = l->face_x[i] * l->direction_x[i] +
                         (l->face_y[i] * l->direction_y[i] + l->face_z[i] * l->direction_z[i]);
    const double height =
        l->offset_mm[i] - (l->face_x[i] * l->origin_x[i] +
                           (l->face_y[i] * l->origin_y[i] + l->face_z[i] * l->origin_z[i]));
    l->slope[i] = slope;
    l->t_mm[i] = height / slope;
  }
  std::int64_t all_steep = 1;
  for (int i = 0; i < kLanes; ++i) {
    all_steep &= std::fabs(l->slope[i]) > flat ? 1 : 0;
  }
  return all_steep == 0;
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

GLINT_WIDE void arrive16(const double* __restrict origin_mm,
                         const double* __restrict direction_x,
                         const double* __restrict direction_y,
                         const double* __restrict direction_z,
                         MeetingLanes& lanes) {
  MeetingLanes* __restrict l = &lanes;
  const double x_mm = origin_mm[0];
  const double y_mm = origin_mm[1];
  const double z_mm = origin_mm[2];
  for (int i = 0; i < kLanes; ++i) {
    l->origin_x[i] = x_mm;
    l->origin_y[i] = y_mm;
    l->origin_z[i] = z_mm;
    l->direction_x[i] = direction_x[i];
    l->direction_y[i] = direction_y[i];
    l->direction_z[i] = direction_z[i];
    l->reflectance[i] = 1.0;
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

GLINT_INLINE void copy(const double* __restrict from, double* __restrict to) {
  for (int i = 0; i < kLanes; ++i) {
    to[i] = from[i];
  }
}

/// In a loop of its own: beside the arithmetic the compiler would branch and not vectorise.
GLINT_INLINE void set_wanted(const double* __restrict is_wanted,
                             const double* __restrict from,
                             double* __restrict to) {
  for (int i = 0; i < kLanes; ++i) {
    const double before = to[i];
    const double now = from[i];
    to[i] = is_wanted[i] != 0.0 ? now : before;
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

GLINT_WIDE void ask_reflected16(const MeetingLanes& lanes,
                                const std::int32_t* __restrict triangle,
                                RayQuery& query) {
  const MeetingLanes* __restrict l = &lanes;
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

GLINT_WIDE void set_plane16(
    double normal_x, double normal_y, double normal_z, double offset_mm, MeetingLanes& lanes) {
  MeetingLanes* __restrict l = &lanes;
  for (int i = 0; i < kLanes; ++i) {
    l->face_x[i] = normal_x;
    l->face_y[i] = normal_y;
    l->face_z[i] = normal_z;
    l->offset_mm[i] = offset_mm;
  }
}

GLINT_WIDE void escape16(const MeetingLanes& lanes, const EscapeArrays& escapes) {
  const MeetingLanes* __restrict l = &lanes;
  const double* const from[] = {l->point_x,
                                l->point_y,
                                l->point_z,
                                l->point_x,
                                l->point_y,
                                l->point_z,
                                l->leaving_x,
                                l->leaving_y,
                                l->leaving_z};
  double* const to[] = {escapes.seen_x,
                        escapes.seen_y,
                        escapes.seen_z,
                        escapes.origin_x,
                        escapes.origin_y,
                        escapes.origin_z,
                        escapes.direction_x,
                        escapes.direction_y,
                        escapes.direction_z};
  for (int k = 0; k < 9; ++k) {
    copy(from[k], to[k]);
  }
}

GLINT_WIDE void escape_again16(const MeetingLanes& lanes,
                               const std::int32_t* __restrict triangle,
                               double reflectance,
                               double* __restrict path_reflectance,
                               const EscapeArrays& escapes,
                               float* __restrict weight) {
  const MeetingLanes* __restrict l = &lanes;
  const double* const from[] = {
      l->point_x, l->point_y, l->point_z, l->leaving_x, l->leaving_y, l->leaving_z};
  double* const to[] = {escapes.origin_x,
                        escapes.origin_y,
                        escapes.origin_z,
                        escapes.direction_x,
                        escapes.direction_y,
                        escapes.direction_z};
  alignas(64) double is_met[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    is_met[i] = triangle[i] >= 0 ? 1.0 : 0.0;
  }
  for (int k = 0; k < 6; ++k) {
    set_wanted(is_met, from[k], to[k]);
  }
  for (int i = 0; i < kLanes; ++i) {
    const double factor = reflectance * l->reflectance[i];
    path_reflectance[i] *= is_met[i] != 0.0 ? factor : 1.0;
  }
  alignas(64) float of_path[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    of_path[i] = static_cast<float>(path_reflectance[i]);
  }
  for (int i = 0; i < kLanes; ++i) {
    const float before = weight[i];
    weight[i] = triangle[i] >= 0 ? of_path[i] : before;
  }
}

GLINT_WIDE bool weigh_escapes16(const MeetingLanes& lanes,
                                const std::int32_t* __restrict triangle,
                                int count,
                                double reflectance,
                                float* __restrict weight) {
  const MeetingLanes* __restrict l = &lanes;
  for (int i = 0; i < kLanes; ++i) {
    weight[i] = static_cast<float>(reflectance * l->reflectance[i]);
  }
  std::int64_t others = 0;
  for (int i = 0; i < kLanes; ++i) {
    const bool is_plain = (triangle[i] >= 0) & !(l->rise[i] <= 0.0);
    others |= ((i >= count) | is_plain) ? 0 : 1;
  }
  return others == 0;
}

GLINT_WIDE bool is_any_unfound16(const std::int32_t* __restrict triangle,
                                 const double* __restrict is_found) {
  std::int64_t unfound = 0;
  for (int i = 0; i < kLanes; ++i) {
    unfound |= ((triangle[i] >= 0) & (is_found[i] == 0.0)) ? 1 : 0;
  }
  return unfound != 0;
}

namespace {

struct alignas(64) ShadedLanes {
  double px[kLanes], py[kLanes], pz[kLanes];
  double nx[kLanes], ny[kLanes], nz[kLanes];
};

}  // namespace

GLINT_WIDE void shade16(const ShadeLanes& shade, MeetingLanes& lanes) {
  const ShadeLanes* __restrict s = &shade;
  MeetingLanes* __restrict l = &lanes;
  ShadedLanes at;
  for (int i = 0; i < kLanes; ++i) {
    const double u = s->u[i];
    const double v = s->v[i];
    const double w = 1.0 - u - v;
    const double nx = w * s->normal_x[0][i] + u * s->normal_x[1][i] + v * s->normal_x[2][i];
    const double ny = w * s->normal_y[0][i] + u * s->normal_y[1][i] + v * s->normal_y[2][i];
    const double nz = w * s->normal_z[0][i] + u * s->normal_z[1][i] + v * s->normal_z[2][i];
    const double length = std::sqrt(nx * nx + (ny * ny + nz * nz));
    const bool has_length = length > 0.0;
    const double scale = 1.0 / (has_length ? length : 1.0);
    at.nx[i] = has_length ? nx * scale : l->face_x[i];
    at.ny[i] = has_length ? ny * scale : l->face_y[i];
    at.nz[i] = has_length ? nz * scale : l->face_z[i];
    at.px[i] = l->origin_x[i] + l->t_mm[i] * l->direction_x[i];
    at.py[i] = l->origin_y[i] + l->t_mm[i] * l->direction_y[i];
    at.pz[i] = l->origin_z[i] + l->t_mm[i] * l->direction_z[i];
  }
  set_wanted(s->is_wanted, at.px, l->point_x);
  set_wanted(s->is_wanted, at.py, l->point_y);
  set_wanted(s->is_wanted, at.pz, l->point_z);
  set_wanted(s->is_wanted, at.nx, l->normal_x);
  set_wanted(s->is_wanted, at.ny, l->normal_y);
  set_wanted(s->is_wanted, at.nz, l->normal_z);
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

GLINT_WIDE void reflect16(double lift_mm, MeetingLanes& lanes) {
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
    l->start_x[i] = l->origin_x[i] + l->t_mm[i] * dx + lift_mm * l->face_x[i];
    l->start_y[i] = l->origin_y[i] + l->t_mm[i] * dy + lift_mm * l->face_y[i];
    l->start_z[i] = l->origin_z[i] + l->t_mm[i] * dz + lift_mm * l->face_z[i];
  }
}

GLINT_WIDE void follow16(const MeetingLanes& from, MeetingLanes& to) {
  const MeetingLanes* __restrict f = &from;
  MeetingLanes* __restrict t = &to;
  for (int i = 0; i < kLanes; ++i) {
    t->origin_x[i] = f->start_x[i];
    t->origin_y[i] = f->start_y[i];
    t->origin_z[i] = f->start_z[i];
    t->direction_x[i] = f->leaving_x[i];
    t->direction_y[i] = f->leaving_y[i];
    t->direction_z[i] = f->leaving_z[i];
    t->reflectance[i] = 1.0;
  }
}

namespace {

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

GLINT_WIDE bool leave_along16(const MeetingLanes& lanes,
                              const std::int32_t* __restrict triangle,
                              const double* __restrict low,
                              const double* __restrict high) {
  constexpr double kMargin = 1e-6;  // of normals and directions
  const MeetingLanes* __restrict l = &lanes;
  std::int64_t others = 0;
  for (int i = 0; i < kLanes; ++i) {
    const double x_low = low[0] * l->leaving_x[i];
    const double x_high = high[0] * l->leaving_x[i];
    const double y_low = low[1] * l->leaving_y[i];
    const double y_high = high[1] * l->leaving_y[i];
    const double z_low = low[2] * l->leaving_z[i];
    const double z_high = high[2] * l->leaving_z[i];
    const double least = (x_low < x_high ? x_low : x_high) + (y_low < y_high ? y_low : y_high) +
                         (z_low < z_high ? z_low : z_high);
    const bool leaves = (l->slope[i] < 0.0) & (least > kMargin);
    others |= ((triangle[i] < 0) | leaves) ? 0 : 1;
  }
  return others == 0;
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
