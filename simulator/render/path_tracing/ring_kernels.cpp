// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/path_tracing/ring_kernels.h"

#include "simulator/render/path_tracing/lane_math.h"
#include "simulator/render/path_tracing/ring_crossings.h"

namespace glint {
namespace {

/// Distances nearer than this share to a sampled one are the sampled surface itself.
constexpr float kSameDistance = 1e-6F;
/// Likewise where a cone may stand in its own way: crossings at grazing are good to that only.
constexpr float kSameCone = 1e-4F;

/// Weights of the emitters at points, as LightTree: [emitter][lane], and their sums.
struct alignas(64) RingWeights {
  float of[RingLights::kMost][kPacketSize];
  float sum[kPacketSize];
};

GLINT_INLINE void weigh(const RingLights& rings,
                        const float* __restrict px,
                        const float* __restrict py,
                        const float* __restrict pz,
                        RingWeights* __restrict weights) {
  for (int i = 0; i < kPacketSize; ++i) {
    weights->sum[i] = 0.0F;
  }
  for (int e = 0; e < rings.count; ++e) {
    const float bx = rings.box_x[e];
    const float by = rings.box_y[e];
    const float bz = rings.box_z[e];
    const float zx = rings.z_x[e];
    const float zy = rings.z_y[e];
    const float zz = rings.z_z[e];
    const float above = zx * rings.origin_x[e] + zy * rings.origin_y[e] + zz * rings.origin_z[e];
    const float radius = rings.box_radius[e];
    const float intensity = rings.intensity[e];
    const float exponent = rings.exponent[e] + 1.0F;
    // Some part of a tilted ring may always show its front.
    const float least_height = rings.tilt_sine[e] != 0.0F ? -kFar_mm : above;
    const float ax = rings.axis_x[e];
    const float ay = rings.axis_y[e];
    const float az = rings.axis_z[e];
    const float cone_cosine = rings.cone_cosine[e];
    const float cone_sine = rings.cone_sine[e];
    alignas(64) float inside[kPacketSize];
    alignas(64) float beyond[kPacketSize];
    alignas(64) float strength[kPacketSize];
    for (int i = 0; i < kPacketSize; ++i) {
      const float wx = px[i] - bx;
      const float wy = py[i] - by;
      const float wz = pz[i] - bz;
      const float distance = std::sqrt(wx * wx + wy * wy + wz * wz);
      const float reach = most(most(distance, radius), 1e-20F);
      const float c = most(-1.0F, least((ax * wx + ay * wy + az * wz) / reach, 1.0F));
      const float s = std::sqrt(most(0.0F, 1.0F - c * c));
      const float box_sine = least(radius / reach, 1.0F);
      const float box_cosine = std::sqrt(most(0.0F, 1.0F - box_sine * box_sine));
      // Of half the cone of normals and half the box together; sine < 0: more than half a turn.
      const float sine = cone_sine * box_cosine + cone_cosine * box_sine;
      const float cosine = cone_cosine * box_cosine - cone_sine * box_sine;
      const float least_cosine = sine < 0.0F ? -2.0F : cosine;
      const float height = zx * px[i] + zy * py[i] + zz * pz[i];
      inside[i] = either(c >= least_cosine, distance <= radius) ? 1.0F : 0.0F;
      beyond[i] = c * cosine + s * sine;
      // Beyond the opposite side the sum of angles would come back.
      strength[i] = height > least_height ? intensity / (reach * reach) : 0.0F;
    }
    for (int i = 0; i < kPacketSize; ++i) {
      beyond[i] = most(0.0F, inside[i] > 0.0F ? 1.0F : beyond[i]);
    }
    if (exponent != 1.0F) {
      for (int i = 0; i < kPacketSize; ++i) {
        beyond[i] = power_of(beyond[i], exponent);
      }
    }
    for (int i = 0; i < kPacketSize; ++i) {
      weights->of[e][i] = strength[i] * beyond[i];
      weights->sum[i] += strength[i] * beyond[i];
    }
  }
}

struct alignas(64) RingChoice {
  std::int32_t emitter[kPacketSize];
  float probability[kPacketSize];  ///< 0: none shines there
  float u[kPacketSize];
};

/// As LightTree::choose().
GLINT_INLINE void choose(const RingLights& rings,
                         const RingWeights* __restrict weights,
                         const float* __restrict u,
                         RingChoice* __restrict choice) {
  alignas(64) float rest[kPacketSize];
  alignas(64) std::int32_t is_done[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    rest[i] = u[i];
    is_done[i] = 0;
    choice->emitter[i] = 0;
    choice->probability[i] = 0.0F;
    choice->u[i] = 0.0F;
  }
  for (int e = 0; e < rings.count; ++e) {
    for (int i = 0; i < kPacketSize; ++i) {
      const float share = weights->of[e][i] / most(weights->sum[i], 1e-30F);
      const bool is_taken = both(is_done[i] == 0, share > 0.0F);
      const float left = least(most(rest[i], 0.0F) / most(share, 1e-30F), 0.99999994F);
      choice->emitter[i] = is_taken ? e : choice->emitter[i];
      choice->probability[i] = is_taken ? share : choice->probability[i];
      choice->u[i] = is_taken ? left : choice->u[i];
      is_done[i] = either(is_done[i] != 0, both(is_taken, rest[i] < share)) ? 1 : 0;
      rest[i] -= share;
    }
  }
}

/// Radiances of emitters along directions.
GLINT_INLINE void shine(const RingLights& rings,
                        const std::int32_t* __restrict emitter,
                        const float* __restrict cosine,
                        ColourLanes* __restrict radiance) {
  for (int c = 0; c < 3; ++c) {
    const float* __restrict const of = rings.radiance[c];
    if (rings.count == 1) {
      for (int i = 0; i < kPacketSize; ++i) {
        radiance->c[c][i] = of[0];
      }
      continue;
    }
    for (int i = 0; i < kPacketSize; ++i) {
      radiance->c[c][i] = of[emitter[i]];
    }
  }
  if (!rings.has_lobes) {
    return;
  }
  for (int i = 0; i < kPacketSize; ++i) {
    const float lobe = power_of(most(cosine[i], 0.0F), rings.exponent[emitter[i]]);
    radiance->c[0][i] *= lobe;
    radiance->c[1][i] *= lobe;
    radiance->c[2][i] *= lobe;
  }
}

/// Of a point on a ring, from its axis and above its middle [mm].
struct RingPlace {
  float radius;
  float height;
};

/// As point_of() in emitter_shape.cpp. @param u  in [0, 1)
template <bool kIsTilted>
GLINT_INLINE RingPlace place_on_ring(const RingLights& r, int e, float u) {
  if constexpr (!kIsTilted) {
    const float inner = r.inner_squared[e];
    return {std::sqrt(inner + u * (r.outer_squared[e] - inner)), 0.0F};
  } else {
    const float c = r.tilt_cosine[e];
    const float m = r.middle[e];
    const float w = r.width[e];
    const float q = m * w * (u - 0.5F) + 0.125F * c * w * w;
    const float along = 2.0F * q / (m + std::sqrt(most(0.0F, m * m + 2.0F * c * q)));
    return {m + along * c, along * r.tilt_sine[e]};
  }
}

/// The choice is of the first where there is only one.
template <bool kIsOne, bool kIsTilted>
GLINT_INLINE void draw(const RingLights& rings,
                       const VectorLanes* __restrict p,
                       const RingChoice* __restrict choice,
                       const float* __restrict v,
                       LightLanes* __restrict l) {
  const RingLights* __restrict const r = &rings;
  alignas(64) float cosines[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    const int e = kIsOne ? 0 : choice->emitter[i];
    const RingPlace place = place_on_ring<kIsTilted>(*r, e, choice->u[i]);
    const SineCosine phi = sine_cosine_of_turns(r->first_turns[e] + v[i] * r->span_turns[e]);
    const float at_x = place.radius * phi.cosine;
    const float at_y = place.radius * phi.sine;
    const float rise = place.height;
    const float wx =
        r->origin_x[e] + at_x * r->x_x[e] + at_y * r->y_x[e] + rise * r->z_x[e] - p->x[i];
    const float wy =
        r->origin_y[e] + at_x * r->x_y[e] + at_y * r->y_y[e] + rise * r->z_y[e] - p->y[i];
    const float wz =
        r->origin_z[e] + at_x * r->x_z[e] + at_y * r->y_z[e] + rise * r->z_z[e] - p->z[i];
    const float squared = most(wx * wx + wy * wy + wz * wz, 1e-30F);
    const float distance = std::sqrt(squared);
    const float dx = wx / distance;
    const float dy = wy / distance;
    const float dz = wz / distance;
    const float down = -(dx * r->z_x[e] + dy * r->z_y[e] + dz * r->z_z[e]);
    float cosine = down;
    if constexpr (kIsTilted) {
      const float along_x = dx * r->x_x[e] + dy * r->x_y[e] + dz * r->x_z[e];
      const float along_y = dx * r->y_x[e] + dy * r->y_y[e] + dz * r->y_z[e];
      const float outwards = phi.cosine * along_x + phi.sine * along_y;
      cosine = r->tilt_cosine[e] * down + r->tilt_sine[e] * outwards;
    }
    const float safe = most(cosine, 1e-30F);
    const float density = choice->probability[i] * squared * r->per_area[e] / safe;
    cosines[i] = cosine;
    l->direction.x[i] = dx;
    l->direction.y[i] = dy;
    l->direction.z[i] = dz;
    l->distance[i] = distance;
    l->density[i] = cosine > 0.0F ? density : 0.0F;
    l->group[i] = r->group[e];
  }
  shine(rings, choice->emitter, cosines, &l->radiance);
}

/// Lights in the way of the drawn directions: others, and the rest of a cone.
GLINT_INLINE void drop_hidden(const RingLights& rings,
                              const VectorLanes* __restrict p,
                              const RingChoice* __restrict choice,
                              LightLanes* __restrict l) {
  alignas(64) float reach[kPacketSize];
  const float share = 1.0F - (rings.has_tilts ? kSameCone : kSameDistance);
  for (int i = 0; i < kPacketSize; ++i) {
    reach[i] = l->distance[i] * share;
  }
  ConeCrossings cone;
  for (int e = 0; e < rings.count; ++e) {
    RingCrossings crossings;
    cross_any(rings,
              e,
              p->x,
              p->y,
              p->z,
              l->direction.x,
              l->direction.y,
              l->direction.z,
              reach,
              &cone,
              &crossings);
    const int itself = rings.tilt_sine[e] != 0.0F ? -1 : e;
    for (int i = 0; i < kPacketSize; ++i) {
      const bool is_hidden = both(crossings.distance[i] < kFar_mm, choice->emitter[i] != itself);
      l->density[i] = is_hidden ? 0.0F : l->density[i];
    }
  }
}

/// The nearest ring of each ray.
struct alignas(64) NearestRings {
  float distance[kPacketSize];
  float cosine[kPacketSize];
  std::int32_t emitter[kPacketSize];
};

GLINT_INLINE void find_nearest(const RingLights& rings,
                               const RayPacket* __restrict rays,
                               const float* __restrict reach,
                               NearestRings* __restrict nearest) {
  for (int i = 0; i < kPacketSize; ++i) {
    nearest->distance[i] = kFar_mm;
    nearest->cosine[i] = 0.0F;
    nearest->emitter[i] = 0;
  }
  ConeCrossings cone;
  for (int e = 0; e < rings.count; ++e) {
    RingCrossings crossings;
    cross_any(rings,
              e,
              rays->origin_x.data(),
              rays->origin_y.data(),
              rays->origin_z.data(),
              rays->direction_x.data(),
              rays->direction_y.data(),
              rays->direction_z.data(),
              reach,
              &cone,
              &crossings);
    for (int i = 0; i < kPacketSize; ++i) {
      const bool is_nearer = crossings.distance[i] < nearest->distance[i];
      nearest->distance[i] = is_nearer ? crossings.distance[i] : nearest->distance[i];
      nearest->cosine[i] = is_nearer ? crossings.cosine[i] : nearest->cosine[i];
      nearest->emitter[i] = is_nearer ? e : nearest->emitter[i];
    }
  }
}

/// The probability to have chosen the nearest ring at the rays' origins.
GLINT_INLINE void chosen_with(const RingLights& rings,
                              const RayPacket* __restrict rays,
                              const NearestRings* __restrict nearest,
                              float* __restrict probability) {
  if (rings.count == 1) {
    for (int i = 0; i < kPacketSize; ++i) {
      probability[i] = 1.0F;
    }
    return;
  }
  RingWeights weights;
  weigh(rings, rays->origin_x.data(), rays->origin_y.data(), rays->origin_z.data(), &weights);
  for (int i = 0; i < kPacketSize; ++i) {
    probability[i] = 0.0F;
  }
  for (int e = 0; e < rings.count; ++e) {
    for (int i = 0; i < kPacketSize; ++i) {
      const float share = weights.of[e][i] / most(weights.sum[i], 1e-30F);
      probability[i] = nearest->emitter[i] == e ? share : probability[i];
    }
  }
}

/// All but the radiances.
template <bool kIsOne>
GLINT_INLINE void describe(const RingLights& rings,
                           const NearestRings* __restrict nearest,
                           const float* __restrict probability,
                           LightHitLanes* __restrict l) {
  const RingLights* __restrict const r = &rings;
  for (int i = 0; i < kPacketSize; ++i) {
    const int e = kIsOne ? 0 : nearest->emitter[i];
    const float distance = nearest->distance[i];
    const float cosine = nearest->cosine[i];
    const float safe = most(cosine, 1e-30F);
    const float density = probability[i] * distance * distance * r->per_area[e] / safe;
    l->cosine[i] = cosine;
    l->density[i] = cosine > 0.0F ? density : 0.0F;
    l->group[i] = r->group[e];
  }
  for (int i = 0; i < kPacketSize; ++i) {
    l->is_met[i] = nearest->distance[i] < kFar_mm ? 1 : 0;
  }
}

}  // namespace

GLINT_WIDE void sample_rings16(const RingLights& rings,
                               const VectorLanes& points,
                               const RandomLanes& random,
                               LightLanes& lights) {
  RingChoice choice;
  if (rings.count == 1) {
    for (int i = 0; i < kPacketSize; ++i) {
      choice.emitter[i] = 0;
      choice.probability[i] = 1.0F;
      choice.u[i] = random.light_u[i];
    }
  } else {
    RingWeights weights;
    weigh(rings, points.x, points.y, points.z, &weights);
    choose(rings, &weights, random.light_u, &choice);
  }
  if (rings.has_tilts) {
    draw<false, true>(rings, &points, &choice, random.light_v, &lights);
  } else if (rings.count == 1) {
    draw<true, false>(rings, &points, &choice, random.light_v, &lights);
    return;
  } else {
    draw<false, false>(rings, &points, &choice, random.light_v, &lights);
  }
  drop_hidden(rings, &points, &choice, &lights);
}

GLINT_WIDE void hit_rings16(const RingLights& rings,
                            const RayPacket& rays,
                            const HitPacket& hits,
                            LightHitLanes& lights) {
  const RayPacket* __restrict const from = &rays;
  const HitPacket* __restrict const before = &hits;
  LightHitLanes* __restrict const l = &lights;
  alignas(64) float reach[kPacketSize];
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    const float to = before->triangle[i] >= 0 ? before->t_mm[i] : kFar_mm;
    reach[i] = from->valid[i] != 0 ? to : 0.0F;
  }
  NearestRings nearest;
  find_nearest(rings, from, reach, &nearest);
  alignas(64) float probability[kPacketSize];
  chosen_with(rings, from, &nearest, probability);
  if (rings.count == 1) {
    describe<true>(rings, &nearest, probability, l);
  } else {
    describe<false>(rings, &nearest, probability, l);
  }
  shine(rings, nearest.emitter, nearest.cosine, &l->radiance);
}

}  // namespace glint
