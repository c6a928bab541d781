// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rough metal for sixteen paths at a time, in float: GGX facets with Smith's masking, directions
// from visible normals, Fresnel's equations, and the light of several reflections between facets
// after Kulla and Conty, whose albedo table is interpolated by cubics. The formulas and their
// sources are those of simulator/material, whose functions in double are the reference of the
// tests; docs/theory/materials.md and path_tracing.md, "Packets". Cost: no branches; memory for the
// table, 360 numbers at most.
#include "simulator/render/path_tracing/conductor_kernels.h"

#include "core/simd.h"
#include "simulator/render/path_tracing/lane_math.h"

namespace glint {
namespace {

using Fresnel = ConductorNumbers::Fresnel;

/// As kMinCosine, for float.
constexpr float kMinCosineOfFloat = 1e-7F;

GLINT_INLINE float length_of(float ax, float ay, float x, float y, float z) {
  return std::sqrt((ax * x) * (ax * x) + (ay * y) * (ay * y) + z * z);
}

/// Weights of four neighbours, as cubic_stencil().
struct alignas(64) StencilLanes {
  std::int32_t first[kPacketSize];
  float w[4][kPacketSize];
};

/// @param place  in [0, count - 1]
GLINT_INLINE void set_stencils(const float* __restrict place,
                               int count,
                               StencilLanes* __restrict s) {
  alignas(64) float low[kPacketSize];   // 1: in the first cell
  alignas(64) float high[kPacketSize];  // 1: in the last
  for (int i = 0; i < kPacketSize; ++i) {
    const auto whole = static_cast<std::int32_t>(place[i]);
    const std::int32_t cell = whole < count - 2 ? whole : count - 2;
    const float t = place[i] - static_cast<float>(cell);
    s->w[0][i] = 0.5F * t * ((2.0F - t) * t - 1.0F);
    s->w[1][i] = 0.5F * ((3.0F * t - 5.0F) * t * t + 2.0F);
    s->w[2][i] = 0.5F * t * ((4.0F - 3.0F * t) * t + 1.0F);
    s->w[3][i] = 0.5F * t * t * (t - 1.0F);
    const std::int32_t before = cell > 0 ? cell - 1 : 0;
    s->first[i] = before < count - 4 ? before : count - 4;
    low[i] = cell == 0 ? 1.0F : 0.0F;
    high[i] = cell == count - 2 ? 1.0F : 0.0F;
  }
  // The ends are continued by parabolas: their weights move to the other three.
  for (int i = 0; i < kPacketSize; ++i) {
    const float w0 = s->w[0][i];
    const float w1 = s->w[1][i];
    const float w2 = s->w[2][i];
    const float w3 = s->w[3][i];
    const float a = low[i];
    const float z = high[i];
    const float middle = 1.0F - a - z;
    s->w[0][i] = middle * w0 + a * (w1 + 3.0F * w0);
    s->w[1][i] = middle * w1 + a * (w2 - 3.0F * w0) + z * (w0 + w3);
    s->w[2][i] = middle * w2 + a * (w3 + w0) + z * (w1 - 3.0F * w3);
    s->w[3][i] = middle * w3 + z * (w2 + 3.0F * w3);
  }
}

GLINT_INLINE void find_rows(const ConductorNumbers& m,
                            const float* __restrict z,
                            StencilLanes* __restrict rows) {
  constexpr float kLast = ConductorNumbers::kRows - 1;
  alignas(64) float place[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    const float in = maximum(0.0F, minimum(z[i], 1.0F));
    const float at = log_of(1.0F + in / m.knee) * m.rows_per_log;
    place[i] = maximum(0.0F, minimum(at, kLast));
  }
  set_stencils(place, ConductorNumbers::kRows, rows);
}

GLINT_INLINE void find_columns(const ConductorNumbers& m,
                               const VectorLanes* __restrict v,
                               StencilLanes* __restrict columns) {
  const auto last = static_cast<float>(m.columns - 1);
  const float per_width = last / (m.alpha_y - m.alpha_x);
  alignas(64) float place[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    const float squared = v->x[i] * v->x[i] + v->y[i] * v->y[i];
    const float ax = m.alpha_x * v->x[i];
    const float ay = m.alpha_y * v->y[i];
    const float across = std::sqrt((ax * ax + ay * ay) / maximum(squared, 1e-24F));
    const float at = (across - m.alpha_x) * per_width;
    const float in = maximum(0.0F, minimum(at, last));
    place[i] = squared < 1e-24F ? 0.0F : in;
  }
  set_stencils(place, m.columns, columns);
}

/// Adds a column's interpolated values, weighted.
GLINT_INLINE void add_column(const float* __restrict table,
                             const StencilLanes* __restrict rows,
                             const std::int32_t* __restrict offset,
                             const float* __restrict weight,
                             float* __restrict sum) {
  for (int i = 0; i < kPacketSize; ++i) {
    const std::int32_t at = offset[i];
    const float value = rows->w[0][i] * table[at] + rows->w[1][i] * table[at + 1] +
                        rows->w[2][i] * table[at + 2] + rows->w[3][i] * table[at + 3];
    sum[i] += weight[i] * value;
  }
}

/// As DirectionTable::at().
GLINT_INLINE void albedo_lanes(const ConductorNumbers& m,
                               const VectorLanes* __restrict v,
                               float* __restrict albedo) {
  StencilLanes rows;
  StencilLanes columns = {};
  find_rows(m, v->z, &rows);
  const int num_columns = m.columns == 1 ? 1 : 4;
  if (m.columns == 1) {
    for (int i = 0; i < kPacketSize; ++i) {
      columns.w[0][i] = 1.0F;
    }
  } else {
    find_columns(m, v, &columns);
  }
  for (int i = 0; i < kPacketSize; ++i) {
    albedo[i] = 0.0F;
  }
  for (int c = 0; c < num_columns; ++c) {
    alignas(64) std::int32_t offset[kPacketSize];
    for (int i = 0; i < kPacketSize; ++i) {
      offset[i] = (columns.first[i] + c) * ConductorNumbers::kRows + rows.first[i];
    }
    add_column(m.albedo, &rows, offset, columns.w[c], albedo);
  }
}

/// As CompensationSampler::density().
GLINT_INLINE float loss_density(const ConductorNumbers& m, float z) {
  const float in = maximum(0.0F, minimum(z, 1.0F));
  const float t = log_of(1.0F + in / m.loss_knee) / m.loss_scale;
  const auto whole = static_cast<int>(t * ConductorNumbers::kCells);
  const int cell = whole < ConductorNumbers::kCells - 1 ? whole : ConductorNumbers::kCells - 1;
  return m.mass[cell] * ConductorNumbers::kCells /
         ((in + m.loss_knee) * m.loss_scale * (2.0F * kPiF));
}

/// As CompensationSampler::sample().
GLINT_INLINE void loss_directions(const ConductorNumbers& metal,
                                  const RandomLanes* __restrict random,
                                  VectorLanes* __restrict to) {
  const ConductorNumbers* const m = &metal;
  std::int32_t cells[kPacketSize] = {};
  for (int k = 1; k < ConductorNumbers::kCells; ++k) {
    for (int i = 0; i < kPacketSize; ++i) {
      cells[i] += random->lobe_v[i] >= m->mass_below[k] ? 1 : 0;
    }
  }
  for (int i = 0; i < kPacketSize; ++i) {
    const int cell = cells[i];
    const float share = minimum(1.0F, (random->lobe_v[i] - m->mass_below[cell]) / m->mass[cell]);
    const float t = (static_cast<float>(cell) + share) / ConductorNumbers::kCells;
    const float z = minimum(1.0F, m->loss_knee * exp_minus_one(t * m->loss_scale));
    const float radius = std::sqrt((1.0F - z) * (1.0F + z));
    const SineCosine phi = sine_cosine_of_turns(random->lobe_u[i]);
    to->x[i] = radius * phi.cosine;
    to->y[i] = radius * phi.sine;
    to->z[i] = z;
  }
}

/// As conductor_reflectance().
GLINT_INLINE float exact_fresnel(float n, float k, float c) {
  const float c2 = c * c;
  const float s2 = 1.0F - c2;
  const float d = n * n - k * k - s2;
  const float sum = std::sqrt(d * d + 4.0F * n * n * k * k);
  const float a = std::sqrt(maximum(0.0F, 0.5F * (sum + d)));
  const float across = (sum + c2 - 2.0F * a * c) / (sum + c2 + 2.0F * a * c);
  const float t1 = c2 * sum + s2 * s2;
  const float t2 = 2.0F * a * c * s2;
  const float both = t1 + t2;
  const float along = across * (t1 - t2) / (both > 0.0F ? both : 1.0F);
  return 0.5F * (across + (both > 0.0F ? along : across));
}

/// Colours of one reflection: tint times Fresnel times what the distribution gives.
GLINT_INLINE void fresnel_lanes(const ConductorNumbers& m,
                                const float* __restrict cosine,
                                const float* __restrict single,
                                ColourLanes* __restrict colour) {
  for (int c = 0; c < 3; ++c) {
    const float tint = m.tint[c];
    const float normal = m.normal[c];
    if (m.fresnel == Fresnel::kConstant) {
      for (int i = 0; i < kPacketSize; ++i) {
        colour->c[c][i] = tint * normal * single[i];
      }
    } else if (m.fresnel == Fresnel::kSchlick) {
      for (int i = 0; i < kPacketSize; ++i) {
        const float rest = 1.0F - cosine[i];
        const float square = rest * rest;
        colour->c[c][i] = tint * (normal + (1.0F - normal) * (square * square * rest)) * single[i];
      }
    } else {
      const float n = m.n[c];
      const float k = m.k[c];
      for (int i = 0; i < kPacketSize; ++i) {
        colour->c[c][i] = tint * exact_fresnel(n, k, cosine[i]) * single[i];
      }
    }
  }
}

/// One reflection: the distribution with masking, and the density of visible normals.
GLINT_INLINE void single_lanes(const ConductorNumbers& m,
                               const LobeLanes* __restrict lobes,
                               const VectorLanes* __restrict v,
                               const VectorLanes* __restrict l,
                               float* __restrict cosine,
                               float* __restrict single,
                               float* __restrict density) {
  const float ax = m.alpha_x;
  const float ay = m.alpha_y;
  for (int i = 0; i < kPacketSize; ++i) {
    const bool is_above = both(v->z[i] > kMinCosineOfFloat, l->z[i] > kMinCosineOfFloat);
    const float hx = v->x[i] + l->x[i];
    const float hy = v->y[i] + l->y[i];
    const float hz = v->z[i] + l->z[i];
    const float squared = hx * hx + hy * hy + hz * hz;
    const float qx = hx / ax;
    const float qy = hy / ay;
    const float e = (qx * qx + qy * qy + hz * hz) / maximum(squared, 1e-30F);
    const float distribution = 1.0F / (kPiF * ax * ay * e * e);
    const float viewer = length_of(ax, ay, v->x[i], v->y[i], v->z[i]);
    const float light = length_of(ax, ay, l->x[i], l->y[i], l->z[i]);
    const float visible = 0.5F * l->z[i] / (l->z[i] * viewer + v->z[i] * light);
    const float along = l->x[i] * hx + l->y[i] * hy + l->z[i] * hz;
    const float c = along / std::sqrt(maximum(squared, 1e-30F));
    cosine[i] = maximum(0.0F, minimum(c, 1.0F));
    single[i] = is_above ? distribution * visible : 0.0F;
    const float of_normals = distribution / (2.0F * (v->z[i] + viewer));
    density[i] = is_above ? (1.0F - lobes->share[i]) * of_normals : 0.0F;
  }
}

GLINT_INLINE void add_compensation(const ConductorNumbers& m,
                                   const LobeLanes* __restrict lobes,
                                   const VectorLanes* __restrict l,
                                   const float* __restrict single,
                                   ReflectionLanes* __restrict r) {
  alignas(64) float albedo[kPacketSize];
  alignas(64) float several[kPacketSize];
  albedo_lanes(m, l, albedo);
  for (int i = 0; i < kPacketSize; ++i) {
    const float brdf =
        maximum(0.0F, (1.0F - lobes->viewer_albedo[i]) * (1.0F - albedo[i]) * m.per_lost);
    const bool is_wanted = both(single[i] > 0.0F, lobes->share[i] > 0.0F);
    several[i] = is_wanted ? brdf * l->z[i] : 0.0F;
    const float more = lobes->share[i] * loss_density(m, l->z[i]);
    r->density[i] += is_wanted ? more : 0.0F;
  }
  for (int c = 0; c < 3; ++c) {
    const float compensation = m.compensation[c];
    for (int i = 0; i < kPacketSize; ++i) {
      r->value.c[c][i] += compensation * several[i];
    }
  }
}

GLINT_INLINE void evaluate_lanes(const ConductorNumbers& m,
                                 const LobeLanes* __restrict lobes,
                                 const VectorLanes* __restrict v,
                                 const VectorLanes* __restrict l,
                                 ReflectionLanes* __restrict r) {
  alignas(64) float cosine[kPacketSize];
  alignas(64) float single[kPacketSize];
  single_lanes(m, lobes, v, l, cosine, single, r->density);
  fresnel_lanes(m, cosine, single, &r->value);
  if (m.columns > 0) {
    add_compensation(m, lobes, l, single, r);
  }
}

/// The directions that visible normals reflect to, as ggx_sample_normal().
GLINT_INLINE void facet_directions(const ConductorNumbers& m,
                                   const VectorLanes* __restrict v,
                                   const RandomLanes* __restrict random,
                                   VectorLanes* __restrict to) {
  const float ax = m.alpha_x;
  const float ay = m.alpha_y;
  for (int i = 0; i < kPacketSize; ++i) {
    const float per_length = 1.0F / maximum(length_of(ax, ay, v->x[i], v->y[i], v->z[i]), 1e-30F);
    const float sx = ax * v->x[i] * per_length;
    const float sy = ay * v->y[i] * per_length;
    const float sz = v->z[i] * per_length;
    const float sum_z = (1.0F - random->lobe_v[i]) * (1.0F + sz);
    const float below = random->lobe_v[i] * (1.0F + sz);  // 1 - z, without cancellation
    const float radius = std::sqrt(maximum(0.0F, below * (2.0F - below)));
    const SineCosine phi = sine_cosine_of_turns(random->lobe_u[i]);
    const float nx = ax * (radius * phi.cosine + sx);
    const float ny = ay * (radius * phi.sine + sy);
    const float squared = nx * nx + ny * ny + sum_z * sum_z;
    const float twice =
        2.0F * (v->x[i] * nx + v->y[i] * ny + v->z[i] * sum_z) / maximum(squared, 1e-30F);
    to->x[i] = twice * nx - v->x[i];
    to->y[i] = twice * ny - v->y[i];
    to->z[i] = twice * sum_z - v->z[i];
  }
}

GLINT_INLINE void take_losses(const ConductorNumbers& m,
                              const LobeLanes* __restrict lobes,
                              const RandomLanes* __restrict random,
                              VectorLanes* __restrict to) {
  VectorLanes lost;
  loss_directions(m, random, &lost);
  for (int i = 0; i < kPacketSize; ++i) {
    const bool is_lost = random->choice[i] < lobes->share[i];
    to->x[i] = is_lost ? lost.x[i] : to->x[i];
    to->y[i] = is_lost ? lost.y[i] : to->y[i];
    to->z[i] = is_lost ? lost.z[i] : to->z[i];
  }
}

}  // namespace

GLINT_WIDE void choose_lobes16(const ConductorNumbers& metal,
                               const VectorLanes& viewer,
                               LobeLanes& lobes) {
  LobeLanes* __restrict const to = &lobes;
  if (metal.columns == 0) {
    for (int i = 0; i < kPacketSize; ++i) {
      to->viewer_albedo[i] = 1.0F;
      to->share[i] = 0.0F;
    }
    return;
  }
  albedo_lanes(metal, &viewer, to->viewer_albedo);
  for (int i = 0; i < kPacketSize; ++i) {
    const float here = metal.compensation_strength * maximum(0.0F, 1.0F - to->viewer_albedo[i]);
    const float single = metal.single_strength * to->viewer_albedo[i];
    const float share = here / maximum(here + single, 1e-30F);
    to->share[i] = here > 0.0F ? share : 0.0F;
  }
}

GLINT_WIDE void evaluate16(const ConductorNumbers& metal,
                           const LobeLanes& lobes,
                           const VectorLanes& viewer,
                           const VectorLanes& to_light,
                           ReflectionLanes& reflection) {
  evaluate_lanes(metal, &lobes, &viewer, &to_light, &reflection);
}

GLINT_WIDE void sample16(const ConductorNumbers& metal,
                         const LobeLanes& lobes,
                         const VectorLanes& viewer,
                         const RandomLanes& random,
                         LeavingLanes& leaving) {
  facet_directions(metal, &viewer, &random, &leaving.to_light);
  if (metal.columns > 0) {
    take_losses(metal, &lobes, &random, &leaving.to_light);
  }
  ReflectionLanes reflection;
  evaluate_lanes(metal, &lobes, &viewer, &leaving.to_light, &reflection);
  LeavingLanes* __restrict const to = &leaving;
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < kPacketSize; ++i) {
      const float density = reflection.density[i];
      const float weight = reflection.value.c[c][i] / (density > 0.0F ? density : 1.0F);
      to->weight.c[c][i] = density > 0.0F ? weight : 0.0F;
    }
  }
  for (int i = 0; i < kPacketSize; ++i) {
    to->density[i] = reflection.density[i];
  }
}

}  // namespace glint
