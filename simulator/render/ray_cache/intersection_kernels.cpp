// SPDX-License-Identifier: GPL-3.0-or-later
//
// What happens to sixteen rays at the surface, each step over all lanes before the next: a plane of
// the triangle gives the point in double, its normal (with the defects' slope) the mirrored
// direction d - 2 (d . n) n. Embree's float hit only says which triangle; points are exact to
// rounding, and lanes without a ray are computed and not looked at. About forty operations a ray,
// all in wide instructions; docs/theory/tunnel.md, "What is kept".
#include "simulator/render/ray_cache/intersection_kernels.h"

#include <cmath>

#include "core/simd.h"

namespace glint {
namespace {

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

GLINT_WIDE bool intersect_planes16(double flat, IntersectionLanes& lanes) {
  IntersectionLanes* __restrict l = &lanes;
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

GLINT_WIDE void arrive16(const double* __restrict origin_mm,
                         const double* __restrict direction_x,
                         const double* __restrict direction_y,
                         const double* __restrict direction_z,
                         IntersectionLanes& lanes) {
  IntersectionLanes* __restrict l = &lanes;
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

GLINT_WIDE void set_plane16(
    double normal_x, double normal_y, double normal_z, double offset_mm, IntersectionLanes& lanes) {
  IntersectionLanes* __restrict l = &lanes;
  for (int i = 0; i < kLanes; ++i) {
    l->face_x[i] = normal_x;
    l->face_y[i] = normal_y;
    l->face_z[i] = normal_z;
    l->offset_mm[i] = offset_mm;
  }
}

GLINT_WIDE void escape16(const IntersectionLanes& lanes, const EscapeArrays& escapes) {
  const IntersectionLanes* __restrict l = &lanes;
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

GLINT_WIDE void escape_again16(const IntersectionLanes& lanes,
                               const std::int32_t* __restrict triangle,
                               double reflectance,
                               double* __restrict path_reflectance,
                               const EscapeArrays& escapes,
                               float* __restrict weight) {
  const IntersectionLanes* __restrict l = &lanes;
  const double* const from[] = {
      l->point_x, l->point_y, l->point_z, l->leaving_x, l->leaving_y, l->leaving_z};
  double* const to[] = {escapes.origin_x,
                        escapes.origin_y,
                        escapes.origin_z,
                        escapes.direction_x,
                        escapes.direction_y,
                        escapes.direction_z};
  alignas(64) double is_hit[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    is_hit[i] = triangle[i] >= 0 ? 1.0 : 0.0;
  }
  for (int k = 0; k < 6; ++k) {
    set_wanted(is_hit, from[k], to[k]);
  }
  for (int i = 0; i < kLanes; ++i) {
    const double factor = reflectance * l->reflectance[i];
    path_reflectance[i] *= is_hit[i] != 0.0 ? factor : 1.0;
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

GLINT_WIDE bool weigh_escapes16(const IntersectionLanes& lanes,
                                const std::int32_t* __restrict triangle,
                                int count,
                                double reflectance,
                                float* __restrict weight) {
  const IntersectionLanes* __restrict l = &lanes;
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

GLINT_WIDE void shade16(const ShadeLanes& shade, IntersectionLanes& lanes) {
  const ShadeLanes* __restrict s = &shade;
  IntersectionLanes* __restrict l = &lanes;
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

GLINT_WIDE void orient16(IntersectionLanes& lanes) {
  IntersectionLanes* __restrict l = &lanes;
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

GLINT_WIDE void reflect16(double lift_mm, IntersectionLanes& lanes) {
  IntersectionLanes* __restrict l = &lanes;
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

GLINT_WIDE void follow16(const IntersectionLanes& from, IntersectionLanes& to) {
  const IntersectionLanes* __restrict f = &from;
  IntersectionLanes* __restrict t = &to;
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

GLINT_WIDE bool leave_along16(const IntersectionLanes& lanes,
                              const std::int32_t* __restrict triangle,
                              const double* __restrict low,
                              const double* __restrict high) {
  constexpr double kMargin = 1e-6;  // of normals and directions
  const IntersectionLanes* __restrict l = &lanes;
  std::int64_t others = 0;
  for (int i = 0; i < kLanes; ++i) {
    const double x_low = low[0] * l->leaving_x[i];
    const double x_high = high[0] * l->leaving_x[i];
    const double y_low = low[1] * l->leaving_y[i];
    const double y_high = high[1] * l->leaving_y[i];
    const double z_low = low[2] * l->leaving_z[i];
    const double z_high = high[2] * l->leaving_z[i];
    const double minimum = (x_low < x_high ? x_low : x_high) + (y_low < y_high ? y_low : y_high) +
                           (z_low < z_high ? z_low : z_high);
    const bool leaves = (l->slope[i] < 0.0) & (minimum > kMargin);
    others |= ((triangle[i] < 0) | leaves) ? 0 : 1;
  }
  return others == 0;
}

}  // namespace glint
