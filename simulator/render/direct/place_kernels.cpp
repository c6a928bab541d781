// SPDX-License-Identifier: GPL-3.0-or-later
//
// Product rules of Gauss-Legendre over panels of lights, and the path tracer's kernel for metal at
// their places. Nodes are the roots of the Legendre polynomials by Newton's method from their
// cosine approximation; how many a panel takes follows from the poles of the integrand (Trefethen
// 2008, docs/theory/direct_light.md, "How many places"). Cost: some 0.2 us for sixteen places.
#include "simulator/render/direct/place_kernels.h"

#include <cmath>

#include "core/simd.h"
#include "simulator/render/path_tracing/lane_math.h"

namespace glint {
namespace {

struct Rule {
  float node[kMaxPlaces];
  float weight[kMaxPlaces];
};

/// Gauss-Legendre rules on [-1, 1] of 1 to kMaxPlaces nodes, weights of sum 1.
struct Rules {
  Rule of[kMaxPlaces + 1];

  Rules() : of() {
    for (int n = 1; n <= kMaxPlaces; ++n) {
      fill(n);
    }
  }

  void fill(int n) {
    for (int i = 0; i < n; ++i) {
      double x = std::cos(static_cast<double>(kPiF) * (i + 0.75) / (n + 0.5));
      double slope = 0.0;
      for (int step = 0; step < 8; ++step) {
        double before = 0.0, value = 1.0;
        for (int k = 0; k < n; ++k) {
          const double next = ((2 * k + 1) * x * value - k * before) / (k + 1);
          before = value;
          value = next;
        }
        slope = n * (x * value - before) / (x * x - 1.0);
        x -= value / slope;
      }
      of[n].node[i] = static_cast<float>(-x);
      of[n].weight[i] = static_cast<float>(1.0 / ((1.0 - x * x) * slope * slope));
    }
  }
};

const Rule& rule_of(int count) {
  static const Rules rules;
  return rules.of[count];
}

void put(const EmitterPlace& place,
         float weight,
         const LocalEmitter& e,
         int index,
         int at,
         PlaceLanes* to) {
  PlaceLanes& packet = to[at / kPacketSize];
  const int lane = at % kPacketSize;
  packet.point.x[lane] = place.point.x;
  packet.point.y[lane] = place.point.y;
  packet.point.z[lane] = place.point.z;
  packet.normal.x[lane] = place.normal.x;
  packet.normal.y[lane] = place.normal.y;
  packet.normal.z[lane] = place.normal.z;
  packet.area_mm2[lane] = weight * place.area_mm2;
  packet.exponent[lane] = e.exponent;
  packet.emitter[lane] = index;
}

GLINT_INLINE void see_places(const float* side,
                             const PlaceLanes* __restrict p,
                             LitLanes* __restrict to) {
  const float side_x = side[0];
  const float side_y = side[1];
  const float side_z = side[2];
  for (int i = 0; i < kPacketSize; ++i) {
    const float x = p->point.x[i];
    const float y = p->point.y[i];
    const float z = p->point.z[i];
    const float distance = std::sqrt(maximum(x * x + y * y + z * z, 1e-20F));
    const float per = 1.0F / distance;
    to->direction.x[i] = per * x;
    to->direction.y[i] = per * y;
    to->direction.z[i] = per * z;
    to->distance_mm[i] = distance;
    const float cosine = -per * (p->normal.x[i] * x + p->normal.y[i] * y + p->normal.z[i] * z);
    const bool is_open = both(cosine > 0.0F, side_x * x + side_y * y + side_z * z > 0.0F);
    const float solid_angle = p->area_mm2[i] * cosine * per * per;
    to->solid_angle[i] = is_open ? solid_angle : 0.0F;
  }
}

GLINT_INLINE void apply_profiles(const PlaceLanes* __restrict p, LitLanes* __restrict to) {
  for (int i = 0; i < kPacketSize; ++i) {
    const float cosine =
        -(p->normal.x[i] * to->direction.x[i] + p->normal.y[i] * to->direction.y[i] +
          p->normal.z[i] * to->direction.z[i]);
    to->solid_angle[i] *= exp_of((p->exponent[i] - 1.0F) * log_of(maximum(cosine, 1e-20F)));
  }
}

}  // namespace

void place_nodes(const LocalEmitter& emitter,
                 const Panel& panel,
                 int count_s,
                 int count_t,
                 int index,
                 int first,
                 PlaceLanes* places) {
  const Rule& of_s = rule_of(count_s);
  const Rule& of_t = rule_of(count_t);
  const bool is_flat = emitter.kind == LocalEmitter::Kind::kFlat;
  PlaceVector radial[kMaxPlaces] = {};
  for (int j = 0; j < count_t && !is_flat; ++j) {
    radial[j] = radial_at(emitter, panel.t + panel.half_t * of_t.node[j]);
  }
  const float area = 4.0F * panel.half_s * panel.half_t;
  int at = first;
  for (int i = 0; i < count_s; ++i) {
    const float s = panel.s + panel.half_s * of_s.node[i];
    const RoundProfile profile = is_flat ? RoundProfile{} : profile_at(emitter, s);
    for (int j = 0; j < count_t; ++j, ++at) {
      const EmitterPlace place = is_flat
                                     ? flat_place(emitter, s, panel.t + panel.half_t * of_t.node[j])
                                     : round_place(emitter, profile, radial[j]);
      put(place, area * of_s.weight[i] * of_t.weight[j], emitter, index, at, places);
    }
  }
}

GLINT_WIDE void light_places16(const ConductorNumbers& metal,
                               const LobeLanes& lobes,
                               const VectorLanes& viewer,
                               const float* side,
                               bool has_lobes,
                               const PlaceLanes& places,
                               LitLanes& lit) {
  see_places(side, &places, &lit);
  if (has_lobes) {
    apply_profiles(&places, &lit);
  }
  evaluate16(metal, lobes, viewer, lit.direction, lit.reflection);
}

}  // namespace glint
