// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many places on a light are enough follows from where its light, as a function of the place,
// has its nearest complex poles: a lobe of GGX, 1 / (1 + |q|^2)^2 in the slope q of the facets in
// widths alpha, has them at |q|^2 = -1; solid angles, n p / |p|^3, at |p|^2 = 0. Gauss-Legendre
// rules converge like rho^(-2 n), rho the sum of the half axes of the ellipse with its foci at the
// panel's ends that goes through the pole (Trefethen, "Is Gauss quadrature better than
// Clenshaw-Curtis?", SIAM Review 2008). docs/theory/direct_light.md. Cost: some 0.1 us a panel.
#include "simulator/render/direct/panel_smoothness.h"

#include <cmath>

#include "simulator/render/path_tracing/lane_math.h"

namespace glint {
namespace {

/// The middle of a panel and the middles of its edges.
struct Cross {
  EmitterPlace middle;
  PlaceVector s[2], t[2];
};

Cross cross_of(const LocalEmitter& e, const Panel& p) {
  Cross cross;
  if (e.kind == LocalEmitter::Kind::kFlat) {
    cross.middle = flat_place(e, p.s, p.t);
    for (int i = 0; i < 2; ++i) {
      const float sign = i == 0 ? -1.0F : 1.0F;
      cross.s[i] = flat_place(e, p.s + sign * p.half_s, p.t).point;
      cross.t[i] = flat_place(e, p.s, p.t + sign * p.half_t).point;
    }
    return cross;
  }
  const PlaceVector radial = radial_at(e, p.t);
  const RoundProfile profile = profile_at(e, p.s);
  cross.middle = round_place(e, profile, radial);
  for (int i = 0; i < 2; ++i) {
    const float sign = i == 0 ? -1.0F : 1.0F;
    cross.s[i] = round_place(e, profile_at(e, p.s + sign * p.half_s), radial).point;
    cross.t[i] = round_place(e, profile, radial_at(e, p.t + sign * p.half_t)).point;
  }
  return cross;
}

struct Slope {
  float x, y;
};

/// Of the facets that reflect the light of a place to the viewer, in widths alpha.
Slope slope_of(const PanelView& view, PlaceVector point) {
  constexpr float kMin = 0.02F;
  const float per_length = 1.0F / std::sqrt(maximum(dot(point, point), 1e-20F));
  const PlaceVector h = per_length * point + vector_of(view.viewer);
  const float per_z = 1.0F / maximum(h.z, kMin);
  return {h.x * per_z / view.alpha_x, h.y * per_z / view.alpha_y};
}

float length_of(float x, float y) {
  return std::sqrt(x * x + y * y);
}

/// Size of the ellipse with foci -1 and 1 through x + i y.
float bernstein(float x, float y) {
  const float a = 0.5F * (length_of(x - 1.0F, y) + length_of(x + 1.0F, y));
  return a + std::sqrt(maximum(0.0F, a * a - 1.0F));
}

/// How a coordinate of a panel runs past a centre of poles: half its length, and the way to the
/// foot of the centre along it, and from there to the centre, in the centre's units.
struct Pass {
  float half, along, aside;
};

Pass pass_of(float squared_length, float product, float squared_middle) {
  const float half = std::sqrt(squared_length);
  const float along = -product / maximum(half, 1e-20F);
  return {half, along, std::sqrt(maximum(0.0F, squared_middle - along * along))};
}

/// @param other  how far the panel reaches aside  @param pole  its height above the centre, squared
float rho_of(const Pass& pass, float other, float pole, float min_aside) {
  const float per_half = 1.0F / maximum(pass.half, 1e-6F);
  const float aside = maximum(min_aside, pass.aside - other);
  return bernstein(pass.along * per_half, std::sqrt(pole + aside * aside) * per_half);
}

struct Passes {
  Pass s, t;
};

Passes slope_passes(const PanelView& view, const Cross& cross, Slope middle) {
  const float squared = middle.x * middle.x + middle.y * middle.y;
  const auto pass = [&](const PlaceVector* ends) {
    const Slope a = slope_of(view, ends[0]);
    const Slope b = slope_of(view, ends[1]);
    const float x = 0.5F * (b.x - a.x);
    const float y = 0.5F * (b.y - a.y);
    Pass straight = pass_of(x * x + y * y, x * middle.x + y * middle.y, squared);
    straight.half = maximum(length_of(a.x - middle.x, a.y - middle.y),  // more where it is bent
                            length_of(b.x - middle.x, b.y - middle.y));
    return straight;
  };
  return {pass(cross.s), pass(cross.t)};
}

Passes place_passes(const Cross& cross) {
  const PlaceVector middle = cross.middle.point;
  const float squared = dot(middle, middle);
  const auto pass = [&](const PlaceVector* ends) {
    const PlaceVector half = 0.5F * (ends[1] - ends[0]);
    return pass_of(dot(half, half), dot(half, middle), squared);
  };
  return {pass(cross.s), pass(cross.t)};
}

/// Where a panel's places lie along a direction: below, above or on both sides of 0.
struct CrossReach {
  float low, high;
};

CrossReach reach_of(const Cross& cross, PlaceVector direction) {
  const float middle = dot(direction, cross.middle.point);
  const auto off = [&](const PlaceVector* ends) {
    return maximum(std::fabs(dot(direction, ends[0]) - middle),
                   std::fabs(dot(direction, ends[1]) - middle));
  };
  const float away = off(cross.s) + off(cross.t);
  return {middle - away, middle + away};
}

/// Of the metal's normal and of the surface's side, the one that hides more.
CrossReach above_horizon(const Cross& cross, const PanelView& view) {
  const CrossReach up = reach_of(cross, {0.0F, 0.0F, 1.0F});
  const CrossReach side = reach_of(cross, vector_of(view.side));
  return {minimum(up.low, side.low), minimum(up.high, side.high)};
}

/// Sines have no pole but are no polynomials either; measured.
float rho_of_arc(float half_rad) {
  return 2.2F / half_rad;
}

/// Above what a panel can add: the highest of the lobe over it times its solid angle.
float bound_of(const LocalEmitter& e,
               const PanelView& view,
               const Panel& p,
               const EmitterPlace& middle,
               const Passes& slopes,
               const Passes& places,
               Slope slope) {
  const float distance = std::sqrt(maximum(dot(middle.point, middle.point), 1e-12F));
  const float height = std::fabs(dot(middle.normal, middle.point));
  const float least = maximum(maximum(height, 1e-6F), distance - places.s.half - places.t.half);
  const float seen = maximum(height / distance, 0.1F);
  const float solid_angle = 4.0F * p.half_s * p.half_t * middle.area_mm2 * seen / (least * least);
  const float nearest = maximum(0.0F, length_of(slope.x, slope.y) - slopes.s.half - slopes.t.half);
  const float e2 = 1.0F + nearest * nearest;
  const float peak = 1.0F / (kPiF * view.alpha_x * view.alpha_y * e2 * e2);
  const float brdf = peak / (4.0F * maximum(view.viewer[2], 0.1F)) + 1.0F / kPiF;
  return e.strongest * minimum(1.0F, brdf * minimum(solid_angle, 2.0F * kPiF));
}

}  // namespace

PanelSmoothness smoothness_of(const LocalEmitter& emitter,
                              const PanelView& view,
                              const Panel& panel) {
  const Cross cross = cross_of(emitter, panel);
  const CrossReach above = above_horizon(cross, view);
  if (above.high <= 0.0F) {
    return {};
  }
  const Slope middle = slope_of(view, cross.middle.point);
  const Passes slopes = slope_passes(view, cross, middle);
  const Passes places = place_passes(cross);
  const float height = std::fabs(dot(cross.middle.normal, cross.middle.point));
  float rho_s = minimum(rho_of(slopes.s, slopes.t.half, 1.0F, 0.0F),
                        rho_of(places.s, places.t.half, 0.0F, height));
  float rho_t = minimum(rho_of(slopes.t, slopes.s.half, 1.0F, 0.0F),
                        rho_of(places.t, places.s.half, 0.0F, height));
  if (emitter.kind != LocalEmitter::Kind::kFlat) {
    rho_t = minimum(rho_t, rho_of_arc(panel.half_t * emitter.span_rad));
  }
  if (emitter.kind == LocalEmitter::Kind::kCap) {
    rho_s = minimum(rho_s, rho_of_arc(panel.half_s * emitter.height_rad));
  }
  return {.bound = bound_of(emitter, view, panel, cross.middle, slopes, places, middle),
          .log2_rho_s = std::log2(rho_s),
          .log2_rho_t = std::log2(rho_t),
          .is_cut = above.low < 0.0F};
}

}  // namespace glint
