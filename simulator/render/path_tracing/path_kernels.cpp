// SPDX-License-Identifier: GPL-3.0-or-later
//
// What sixteen paths do between two searches, in float: leave the camera, meet plane triangles,
// turn directions into the frame of the surface, weight light by the power heuristic (Veach and
// Guibas 1995), and end at random (Russian roulette). Loops over the lanes without branches,
// compiled for several instruction sets; even `&&` would keep them scalar (lane_math.h).
// docs/theory/path_tracing.md, "Packets". Cost: small beside the search for hits; no memory.
#include "simulator/render/path_tracing/path_kernels.h"

#include <limits>

#include "core/simd.h"
#include "simulator/render/path_tracing/lane_math.h"
#include "simulator/render/path_tracing/sobol.h"

namespace glint {
namespace {

GLINT_INLINE float unit_of(std::uint32_t bits) {
  return static_cast<float>(static_cast<std::int32_t>(bits >> 8U)) * 0x1p-24F;
}

/// As disc_from_square().
GLINT_INLINE void lens_points(const CameraLanes* __restrict lanes,
                              float radius_mm,
                              float* __restrict x,
                              float* __restrict y) {
  for (int i = 0; i < kPacketSize; ++i) {
    const float a = 2.0F * lanes->lens_u[i] - 1.0F;
    const float b = 2.0F * lanes->lens_v[i] - 1.0F;
    const bool is_wide = std::abs(a) > std::abs(b);
    const float large = is_wide ? a : b;
    const float small = is_wide ? b : a;
    const float angle = 0.25F * kPiF * small / (large != 0.0F ? large : 1.0F);
    const SineCosine at = small_sine_cosine(angle);
    x[i] = radius_mm * large * (is_wide ? at.cosine : at.sine);
    y[i] = radius_mm * large * (is_wide ? at.sine : at.cosine);
  }
}

/// Along and across the lay's direction: circles around its axis.
GLINT_INLINE void turned(const float* __restrict u,
                         const float* __restrict v,
                         float* __restrict along,
                         float* __restrict across) {
  for (int i = 0; i < kPacketSize; ++i) {
    const float per_radius = 1.0F / maximum(std::sqrt(u[i] * u[i] + v[i] * v[i]), 1e-30F);
    along[i] = -v[i] * per_radius;
    across[i] = u[i] * per_radius;
  }
}

/// Arcs of a mill.
GLINT_INLINE void milled(const LayNumbers& lay,
                         const float* __restrict v,
                         float* __restrict along,
                         float* __restrict across) {
  const float radius_mm = lay.radius_mm;
  for (int i = 0; i < kPacketSize; ++i) {
    const float lanes = v[i] / lay.lane_mm;
    const float half = lanes < 0.0F ? -0.5F : 0.5F;
    const auto whole = static_cast<float>(static_cast<std::int32_t>(lanes + half));
    const float aside = v[i] - lay.lane_mm * whole;
    const float ahead = std::sqrt(maximum(0.0F, (radius_mm - aside) * (radius_mm + aside)));
    along[i] = -aside / radius_mm;
    across[i] = ahead / radius_mm;
  }
}

/// Unnormalised direction of the grooves.
GLINT_INLINE void grooves(const LayNumbers& lay,
                          const VectorLanes* __restrict point,
                          VectorLanes* __restrict groove) {
  const LayNumbers n = lay;
  alignas(64) float u[kPacketSize];
  alignas(64) float v[kPacketSize];
  alignas(64) float along[kPacketSize];
  alignas(64) float across[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    u[i] = point->x[i] * n.u[0] + point->y[i] * n.u[1] + point->z[i] * n.u[2] - n.centre_u_mm;
    v[i] = point->x[i] * n.v[0] + point->y[i] * n.v[1] + point->z[i] * n.v[2] - n.centre_v_mm;
    along[i] = 1.0F;
    across[i] = 0.0F;
  }
  if (n.kind == LayNumbers::Kind::kTurned) {
    turned(u, v, along, across);
  } else if (n.kind == LayNumbers::Kind::kMilled) {
    milled(n, v, along, across);
  }
  for (int i = 0; i < kPacketSize; ++i) {
    groove->x[i] = along[i] * n.u[0] + across[i] * n.v[0];
    groove->y[i] = along[i] * n.u[1] + across[i] * n.v[1];
    groove->z[i] = along[i] * n.u[2] + across[i] * n.v[2];
  }
}

/// Points on the planes, the sides the rays came from, where rays leave.
GLINT_INLINE void place(const TriangleLanes* __restrict t,
                        float start_offset_mm,
                        const RayPacket* __restrict r,
                        const HitPacket* __restrict h,
                        SurfaceLanes* __restrict s) {
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const float dx = r->direction_x[i];
    const float dy = r->direction_y[i];
    const float dz = r->direction_z[i];
    const float px = r->origin_x[i] + h->t_mm[i] * dx;
    const float py = r->origin_y[i] + h->t_mm[i] * dy;
    const float pz = r->origin_z[i] + h->t_mm[i] * dz;
    const float fx = t->face.x[i];
    const float fy = t->face.y[i];
    const float fz = t->face.z[i];
    const bool is_flat = fx * fx + fy * fy + fz * fz > 0.5F;
    // Along the ray t is good to 1e-7 of its length; the plane is known better.
    const float height = is_flat ? fx * px + fy * py + fz * pz - t->offset_mm[i] : 0.0F;
    const float outside = fx * dx + fy * dy + fz * dz > 0.0F ? -1.0F : 1.0F;
    const float sx = is_flat ? outside * fx : -dx;
    const float sy = is_flat ? outside * fy : -dy;
    const float sz = is_flat ? outside * fz : -dz;
    s->point.x[i] = px - height * fx;
    s->point.y[i] = py - height * fy;
    s->point.z[i] = pz - height * fz;
    s->side.x[i] = sx;
    s->side.y[i] = sy;
    s->side.z[i] = sz;
    s->start.x[i] = s->point.x[i] + start_offset_mm * sx;
    s->start.y[i] = s->point.y[i] + start_offset_mm * sy;
    s->start.z[i] = s->point.z[i] + start_offset_mm * sz;
  }
}

/// Interpolated normals on the viewer's side, bent where the viewer could not see them.
GLINT_INLINE void shade(const TriangleLanes* __restrict t,
                        const RayPacket* __restrict r,
                        const HitPacket* __restrict h,
                        SurfaceLanes* __restrict s) {
  constexpr float kMin = 1e-4F;
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const float u = h->u[i];
    const float v = h->v[i];
    const float w = 1.0F - u - v;
    const float cx = w * t->corner[0].x[i] + u * t->corner[1].x[i] + v * t->corner[2].x[i];
    const float cy = w * t->corner[0].y[i] + u * t->corner[1].y[i] + v * t->corner[2].y[i];
    const float cz = w * t->corner[0].z[i] + u * t->corner[1].z[i] + v * t->corner[2].z[i];
    const float fx = t->face.x[i];
    const float fy = t->face.y[i];
    const float fz = t->face.z[i];
    const bool is_smooth = cx * fx + cy * fy + cz * fz > 0.0F;
    const float squared = cx * cx + cy * cy + cz * cz;
    const float outside = s->side.x[i] * fx + s->side.y[i] * fy + s->side.z[i] * fz;
    const float scale = outside / std::sqrt(is_smooth ? squared : 1.0F);
    const float nx = is_smooth ? scale * cx : s->side.x[i];
    const float ny = is_smooth ? scale * cy : s->side.y[i];
    const float nz = is_smooth ? scale * cz : s->side.z[i];
    const float vx = -r->direction_x[i];
    const float vy = -r->direction_y[i];
    const float vz = -r->direction_z[i];
    const float cosine = nx * vx + ny * vy + nz * vz;
    const float lift = cosine >= kMin ? 0.0F : kMin - cosine;
    const float bx = nx + lift * vx;
    const float by = ny + lift * vy;
    const float bz = nz + lift * vz;
    const float length = std::sqrt(bx * bx + by * by + bz * bz);
    s->normal.x[i] = bx / length;
    s->normal.y[i] = by / length;
    s->normal.z[i] = bz / length;
  }
}

/// For each normal some tangent, the same in the part's frame whatever its pose: as any_tangent().
GLINT_INLINE void any_tangents(const LayNumbers& lay,
                               const VectorLanes* __restrict normal,
                               VectorLanes* __restrict tangent) {
  const float* const r = lay.part;
  for (int i = 0; i < kPacketSize; ++i) {
    const float x = r[0] * normal->x[i] + r[3] * normal->y[i] + r[6] * normal->z[i];
    const float y = r[1] * normal->x[i] + r[4] * normal->y[i] + r[7] * normal->z[i];
    const float z = r[2] * normal->x[i] + r[5] * normal->y[i] + r[8] * normal->z[i];
    const float sign = z < 0.0F ? -1.0F : 1.0F;
    const float a = -1.0F / (sign + z);
    const float tx = 1.0F + sign * x * x * a;
    const float ty = sign * x * y * a;
    const float tz = -sign * x;
    tangent->x[i] = r[0] * tx + r[1] * ty + r[2] * tz;
    tangent->y[i] = r[3] * tx + r[4] * ty + r[5] * tz;
    tangent->z[i] = r[6] * tx + r[7] * ty + r[8] * tz;
  }
}

/// Tangents laid into the surface, as frame_at(), and the viewer in that frame.
/// @param other  tangents where the groove stands along the normal
GLINT_INLINE void frame(const VectorLanes* __restrict groove,
                        const VectorLanes* __restrict other,
                        const RayPacket* __restrict r,
                        SurfaceLanes* __restrict s) {
  constexpr float kMinShare = 1e-5F;
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const float nx = s->normal.x[i];
    const float ny = s->normal.y[i];
    const float nz = s->normal.z[i];
    const float up = groove->x[i] * nx + groove->y[i] * ny + groove->z[i] * nz;
    const float gx = groove->x[i] - up * nx;
    const float gy = groove->y[i] - up * ny;
    const float gz = groove->z[i] - up * nz;
    const float length = std::sqrt(gx * gx + gy * gy + gz * gz);
    const bool is_good = length > kMinShare;
    const float scale = 1.0F / maximum(length, kMinShare);
    const float tx = is_good ? scale * gx : other->x[i];
    const float ty = is_good ? scale * gy : other->y[i];
    const float tz = is_good ? scale * gz : other->z[i];
    const float bx = ny * tz - nz * ty;
    const float by = nz * tx - nx * tz;
    const float bz = nx * ty - ny * tx;
    const float vx = -r->direction_x[i];
    const float vy = -r->direction_y[i];
    const float vz = -r->direction_z[i];
    s->tangent.x[i] = tx;
    s->tangent.y[i] = ty;
    s->tangent.z[i] = tz;
    s->bitangent.x[i] = bx;
    s->bitangent.y[i] = by;
    s->bitangent.z[i] = bz;
    s->viewer.x[i] = tx * vx + ty * vy + tz * vz;
    s->viewer.y[i] = bx * vx + by * vy + bz * vz;
    s->viewer.z[i] = nx * vx + ny * vy + nz * vz;
    // 1 - n v without its cancellation.
    const float ex = nx - vx;
    const float ey = ny - vy;
    const float ez = nz - vz;
    s->tilt[i] = 0.5F * (ex * ex + ey * ey + ez * ez);
  }
}

/// Turns the rays of paths to the chosen directions.
/// @param up, open  heights of these above the side they leave and the open half space
GLINT_INLINE void turn(const SurfaceLanes* __restrict s,
                       const LeavingLanes* __restrict l,
                       PathPacket* __restrict p,
                       float* __restrict up,
                       float* __restrict open) {
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const float x = l->to_light.x[i];
    const float y = l->to_light.y[i];
    const float z = l->to_light.z[i];
    const float dx = s->tangent.x[i] * x + s->bitangent.x[i] * y + s->normal.x[i] * z;
    const float dy = s->tangent.y[i] * x + s->bitangent.y[i] * y + s->normal.y[i] * z;
    const float dz = s->tangent.z[i] * x + s->bitangent.z[i] * y + s->normal.z[i] * z;
    up[i] = s->side.x[i] * dx + s->side.y[i] * dy + s->side.z[i] * dz;
    open[i] = s->open.x[i] * dx + s->open.y[i] * dy + s->open.z[i] * dz;
    p->ray.direction_x[i] = dx;
    p->ray.direction_y[i] = dy;
    p->ray.direction_z[i] = dz;
  }
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    p->ray.origin_x[i] = s->start.x[i];
    p->ray.origin_y[i] = s->start.y[i];
    p->ray.origin_z[i] = s->start.z[i];
    p->ray.t_max[i] = std::numeric_limits<float>::infinity();
    p->density[i] = l->density[i];
  }
}

}  // namespace

GLINT_WIDE void camera_rays16(const CameraNumbers& camera,
                              const CameraLanes& lanes,
                              RayPacket& rays) {
  const CameraNumbers c = camera;
  const CameraLanes* __restrict const l = &lanes;
  RayPacket* __restrict const to = &rays;
  alignas(64) float lens_x[kPacketSize] = {};
  alignas(64) float lens_y[kPacketSize] = {};
  if (c.aperture_mm > 0.0F) {
    lens_points(l, 0.5F * c.aperture_mm, lens_x, lens_y);
  }
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const float x = l->column[i] + l->x_px[i] * c.per_focal_x - lens_x[i] * c.per_focus;
    const float y = l->row[i] + l->y_px[i] * c.per_focal_y - lens_y[i] * c.per_focus;
    const float z = 1.0F / std::sqrt(x * x + y * y + 1.0F);
    const float* const r = c.rotation;
    to->origin_x[i] = c.origin[0] + r[0] * lens_x[i] + r[1] * lens_y[i];
    to->origin_y[i] = c.origin[1] + r[3] * lens_x[i] + r[4] * lens_y[i];
    to->origin_z[i] = c.origin[2] + r[6] * lens_x[i] + r[7] * lens_y[i];
    to->direction_x[i] = (r[0] * x + r[1] * y + r[2]) * z;
    to->direction_y[i] = (r[3] * x + r[4] * y + r[5]) * z;
    to->direction_z[i] = (r[6] * x + r[7] * y + r[8]) * z;
  }
}

GLINT_WIDE void random_pairs16(const std::uint32_t* __restrict seed,
                               const std::uint32_t* __restrict index,
                               std::uint32_t dimension,
                               float* __restrict u,
                               float* __restrict v) {
  const std::uint32_t of_dimension = hash_bits(dimension + 0x9e3779b9U);
  for (int i = 0; i < kPacketSize; ++i) {
    const std::uint32_t key = hash_bits(seed[i] ^ of_dimension);
    const std::uint32_t shuffled = reversed_bits(scramble_reversed(reversed_bits(index[i]), key));
    const std::uint32_t x = scramble_reversed(shuffled, hash_bits(key + 1U));
    const std::uint32_t y = scramble_reversed(second_sobol_reversed(shuffled), hash_bits(key + 2U));
    u[i] = unit_of(reversed_bits(x));
    v[i] = unit_of(reversed_bits(y));
  }
}

GLINT_WIDE void intersect_triangles16(const TriangleLanes& triangles,
                                      const LayNumbers& lay,
                                      float start_offset_mm,
                                      const RayPacket& rays,
                                      const HitPacket& hits,
                                      SurfaceLanes& surface) {
  place(&triangles, start_offset_mm, &rays, &hits, &surface);
  shade(&triangles, &rays, &hits, &surface);
  VectorLanes groove;
  VectorLanes other;
  grooves(lay, &surface.point, &groove);
  any_tangents(lay, &surface.normal, &other);
  frame(&groove, &other, &rays, &surface);
}

GLINT_WIDE void to_local16(const SurfaceLanes& surface,
                           const VectorLanes& directions,
                           VectorLanes& local) {
  const SurfaceLanes* __restrict const s = &surface;
  const VectorLanes* __restrict const d = &directions;
  VectorLanes* __restrict const to = &local;
  for (int i = 0; i < kPacketSize; ++i) {
    to->x[i] = d->x[i] * s->tangent.x[i] + d->y[i] * s->tangent.y[i] + d->z[i] * s->tangent.z[i];
    to->y[i] =
        d->x[i] * s->bitangent.x[i] + d->y[i] * s->bitangent.y[i] + d->z[i] * s->bitangent.z[i];
    to->z[i] = d->x[i] * s->normal.x[i] + d->y[i] * s->normal.y[i] + d->z[i] * s->normal.z[i];
  }
}

GLINT_WIDE void arrive16(const PathPacket& paths,
                         bool by_choice,
                         const LightHitLanes& lights,
                         ArrivingLanes& arriving) {
  const PathPacket* __restrict const p = &paths;
  const LightHitLanes* __restrict const l = &lights;
  ArrivingLanes* __restrict const to = &arriving;
  alignas(64) float share[kPacketSize];
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const bool has_rival = both(by_choice, p->density[i] > 0.0F);
    const float of_rivals = power_share(has_rival ? p->density[i] : 1.0F, l->density[i]);
    share[i] = has_rival ? of_rivals : 1.0F;
    const bool is_bright = both(both(p->ray.valid[i] != 0, l->is_hit[i] != 0), l->cosine[i] > 0.0F);
    to->is_bright[i] = is_bright ? 1 : 0;
    to->is_open[i] = 1;
  }
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < kPacketSize; ++i) {
      to->radiance.c[c][i] = share[i] * p->weight.c[c][i] * l->radiance.c[c][i];
    }
  }
}

GLINT_WIDE void connect16(const PathPacket& paths,
                          const SurfaceLanes& surface,
                          const LightLanes& lights,
                          const ReflectionLanes& reflection,
                          ArrivingLanes& arriving) {
  const PathPacket* __restrict const p = &paths;
  const SurfaceLanes* __restrict const s = &surface;
  const LightLanes* __restrict const l = &lights;
  const ReflectionLanes* __restrict const r = &reflection;
  ArrivingLanes* __restrict const to = &arriving;
  alignas(64) float share[kPacketSize];
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const float dx = l->direction.x[i];
    const float dy = l->direction.y[i];
    const float dz = l->direction.z[i];
    const float up = s->side.x[i] * dx + s->side.y[i] * dy + s->side.z[i] * dz;
    const float open = s->open.x[i] * dx + s->open.y[i] * dy + s->open.z[i] * dz;
    const bool is_drawn = both(both(p->ray.valid[i] != 0, l->density[i] > 0.0F), up > 0.0F);
    const float density = is_drawn ? l->density[i] : 1.0F;
    share[i] = is_drawn ? power_share(density, r->density[i]) / density : 0.0F;
    to->is_open[i] = open > 0.0F ? 1 : 0;
  }
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < kPacketSize; ++i) {
      to->radiance.c[c][i] = share[i] * p->weight.c[c][i] * r->value.c[c][i] * l->radiance.c[c][i];
    }
  }
  for (int i = 0; i < kPacketSize; ++i) {
    const float strongest =
        maximum(to->radiance.c[0][i], maximum(to->radiance.c[1][i], to->radiance.c[2][i]));
    // What is no number goes on, to be counted.
    to->is_bright[i] = both(share[i] > 0.0F, !(strongest <= 0.0F)) ? 1 : 0;
  }
}

GLINT_WIDE void leave16(const SurfaceLanes& surface,
                        const LeavingLanes& leaving,
                        const float* roulette,
                        PathPacket& paths,
                        std::int32_t* __restrict is_open) {
  const SurfaceLanes* __restrict const s = &surface;
  const LeavingLanes* __restrict const l = &leaving;
  PathPacket* __restrict const p = &paths;
  alignas(64) float chance[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    chance[i] = roulette != nullptr ? roulette[i] : -1.0F;
  }
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < kPacketSize; ++i) {
      p->weight.c[c][i] *= l->weight.c[c][i];
    }
  }
  alignas(64) float up[kPacketSize];
  alignas(64) float open[kPacketSize];
  turn(s, l, p, up, open);
  alignas(64) float survival[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    const float strongest =
        maximum(p->weight.c[0][i], maximum(p->weight.c[1][i], p->weight.c[2][i]));
    const float likely = minimum(1.0F, maximum(strongest, 0.0F));
    survival[i] = chance[i] < 0.0F ? 1.0F : likely;
    // Below the surface and black ones do not survive either.
    const float smaller_of_both = minimum(up[i], strongest);
    survival[i] = smaller_of_both > 0.0F ? survival[i] : 0.0F;
  }
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const std::int32_t before = p->ray.valid[i];
    const std::int32_t after = both(survival[i] > 0.0F, chance[i] < survival[i]) ? before : 0;
    p->ray.valid[i] = after;
    is_open[i] = open[i] > 0.0F ? 1 : 0;
  }
  for (int i = 0; i < kPacketSize; ++i) {
    const float safe = survival[i] > 0.0F ? survival[i] : 1.0F;
    chance[i] = 1.0F / safe;
  }
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < kPacketSize; ++i) {
      p->weight.c[c][i] *= chance[i];
    }
  }
}

}  // namespace glint
