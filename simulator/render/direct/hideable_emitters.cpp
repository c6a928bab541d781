// SPDX-License-Identifier: GPL-3.0-or-later
//
// A hides B from a point p only where A meets the convex hull of p and B. So planes are looked for
// that have A on one side, B and the box on the other: across the axes, along A and along B. What
// lies on a sphere or cone around the box is not parted by planes and needs none.
#include "simulator/render/direct/hideable_emitters.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glint {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Surfaces that touch within this do not hide each other [mm].
constexpr double kTouching_mm = 1e-6;

/// Where something lies along a direction.
struct Reach {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double at) {
    low = std::min(low, at);
    high = std::max(high, at);
  }

  void add(const Reach& other) {
    add(other.low);
    add(other.high);
  }
};

Reach reach_of(const RectangleShape& s, const Vector3d& d) {
  const double middle = s.frame.origin_mm.dot(d);
  const double away =
      std::abs(s.half_x_mm * s.frame.x.dot(d)) + std::abs(s.half_y_mm * s.frame.y.dot(d));
  return {.low = middle - away, .high = middle + away};
}

/// Of the whole circles.
Reach reach_of(const RingShape& s, const Vector3d& d) {
  Reach reach;
  const double along = s.frame.z.dot(d);
  const double across = std::hypot(s.frame.x.dot(d), s.frame.y.dot(d));
  for (const double side : {-0.5, 0.5}) {
    const double r = s.middle_radius_mm + side * s.width_mm * std::cos(s.tilt_rad);
    const double h = side * s.width_mm * std::sin(s.tilt_rad);
    const double middle = s.frame.origin_mm.dot(d) + h * along;
    reach.add(middle - r * across);
    reach.add(middle + r * across);
  }
  return reach;
}

/// Of the whole sphere.
Reach reach_of(const CapShape& s, const Vector3d& d) {
  const double middle = s.frame.origin_mm.dot(d);
  return {.low = middle - s.radius_mm, .high = middle + s.radius_mm};
}

Reach reach_of(const TriangleShape& s, const Vector3d& d) {
  Reach reach;
  for (const Vector3d& corner : {s.a_mm, s.b_mm, s.c_mm}) {
    reach.add(corner.dot(d));
  }
  return reach;
}

Reach reach_of(const AlignedBox3d& box, const Vector3d& d) {
  const double middle = box.center().dot(d);
  const double away = 0.5 * box.sizes().cwiseProduct(d.cwiseAbs()).sum();
  return {.low = middle - away, .high = middle + away};
}

Reach reach_of(const EmitterShape& shape, const Vector3d& d) {
  return std::visit([&d](const auto& s) { return reach_of(s, d); }, shape);
}

/// A sphere's inside is convex: what is seen of one point of it from another is not hidden by it.
bool is_around(const EmitterShape& a, const EmitterShape& b, const AlignedBox3d& box) {
  const auto* cap = std::get_if<CapShape>(&a);
  if (cap == nullptr) {
    return false;
  }
  const AlignedBox3d both = box.merged(bounds_mm(b));
  const Vector3d furthest = (both.max() - cap->frame.origin_mm)
                                .cwiseAbs()
                                .cwiseMax((both.min() - cap->frame.origin_mm).cwiseAbs());
  return furthest.norm() < cap->radius_mm;
}

bool are_parted(const EmitterShape& a, const EmitterShape& b, const AlignedBox3d& box) {
  const Vector3d directions[] = {Vector3d::UnitX(),
                                 Vector3d::UnitY(),
                                 Vector3d::UnitZ(),
                                 normal_cone(a).axis,
                                 normal_cone(b).axis};
  return std::ranges::any_of(directions, [&](const Vector3d& d) {
    const Reach of_a = reach_of(a, d);
    Reach rest = reach_of(b, d);
    rest.add(reach_of(box, d));
    return of_a.high <= rest.low + kTouching_mm || of_a.low >= rest.high - kTouching_mm;
  });
}

/// Whether a point lies inside the nappe of the cone that a ring is a strip of, off its surface.
bool is_inside_cone(const RingShape& s, const Vector3d& point_mm) {
  const Vector3d away = point_mm - s.frame.origin_mm;
  const double radius = std::hypot(away.dot(s.frame.x), away.dot(s.frame.y));
  const double sine = std::abs(std::sin(s.tilt_rad));
  const double along = std::copysign(std::cos(s.tilt_rad), s.tilt_rad) * away.dot(s.frame.z);
  return (radius - s.middle_radius_mm) * sine < along - kTouching_mm;
}

bool are_of_one_cone(const RingShape& a, const RingShape& b) {
  return a.tilt_rad == b.tilt_rad && a.middle_radius_mm == b.middle_radius_mm &&
         a.width_mm == b.width_mm && a.frame.origin_mm == b.frame.origin_mm &&
         a.frame.z == b.frame.z;
}

/// A nappe's inside is convex: from there sectors of its surface do not hide each other.
bool is_inside_their_cone(const EmitterShape& a, const EmitterShape& b, const AlignedBox3d& box) {
  const auto* of_a = std::get_if<RingShape>(&a);
  const auto* of_b = std::get_if<RingShape>(&b);
  if (of_a == nullptr || of_b == nullptr || !are_of_one_cone(*of_a, *of_b)) {
    return false;
  }
  constexpr int kCorners = 8;
  for (int k = 0; k < kCorners; ++k) {
    if (!is_inside_cone(*of_a, box.corner(static_cast<AlignedBox3d::CornerType>(k)))) {
      return false;
    }
  }
  return true;
}

/// Fronts hide what is behind them too; sectors of one flat ring do not hide each other.
bool might_hide(const Emitter& a, const Emitter& b, const AlignedBox3d& box) {
  return !is_around(a.shape, b.shape, box) && !is_inside_their_cone(a.shape, b.shape, box) &&
         !are_parted(a.shape, b.shape, box);
}

}  // namespace

std::optional<std::size_t> emitter_before(const Lights& lights,
                                          std::size_t emitter,
                                          const AlignedBox3d& box_mm) {
  for (std::size_t a = 0; a < lights.emitters.size(); ++a) {
    if (a != emitter && might_hide(lights.emitters[a], lights.emitters[emitter], box_mm)) {
      return a;
    }
  }
  return std::nullopt;
}

std::vector<std::uint8_t> hideable_emitters(const Lights& lights, const AlignedBox3d& box_mm) {
  const std::size_t count = lights.emitters.size();
  std::vector<std::uint8_t> hideable(count, count > kMaxPartedEmitters ? 1 : 0);
  for (std::size_t b = 0; b < count && count <= kMaxPartedEmitters; ++b) {
    hideable[b] = emitter_before(lights, b, box_mm) ? 1 : 0;
  }
  return hideable;
}

}  // namespace glint
