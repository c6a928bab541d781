// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/emitter_shape.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace glint {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Below this a ring is flat to any ray: the slope's height is less than a rounding error.
constexpr double kFlat_rad = 1e-9;

using Crossings = std::array<std::optional<ShapeCrossing>, 2>;

std::optional<ShapeCrossing> nearest(const Crossings& crossings, double max_mm, bool fronts_only) {
  std::optional<ShapeCrossing> best;
  for (const auto& c : crossings) {
    if (c && c->distance_mm > 0.0 && c->distance_mm < max_mm && (!fronts_only || c->cosine > 0.0) &&
        (!best || c->distance_mm < best->distance_mm)) {
      best = c;
    }
  }
  return best;
}

AlignedBox3d global_box(const EmitterFrame& frame, const AlignedBox3d& local) {
  AlignedBox3d box;
  for (int corner = 0; corner < 8; ++corner) {
    const auto type = static_cast<AlignedBox3d::CornerType>(corner);
    box.extend(frame.origin_mm + frame.global(local.corner(type)));
  }
  return box;
}

/// The real roots of a t^2 + 2 b t + c, without cancellation; infinite or NaN where there is none.
std::array<double, 2> roots(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0.0)) {
    return {std::nan(""), std::nan("")};
  }
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  return {q / a, c / q};
}

// --- rectangle
// ------------------------------------------------------------------------------------

double area_of(const RectangleShape& s) {
  return 4.0 * s.half_x_mm * s.half_y_mm;
}

ShapePoint point_of(const RectangleShape& s, double u, double v) {
  const double x = (2.0 * u - 1.0) * s.half_x_mm;
  const double y = (2.0 * v - 1.0) * s.half_y_mm;
  return {.point_mm = s.frame.origin_mm + x * s.frame.x + y * s.frame.y, .normal = s.frame.z};
}

AlignedBox3d box_of(const RectangleShape& s) {
  const Vector3d half(s.half_x_mm, s.half_y_mm, 0.0);
  return global_box(s.frame, AlignedBox3d(-half, half));
}

NormalCone cone_of(const RectangleShape& s) {
  return {.axis = s.frame.z, .half_angle_rad = 0.0};
}

Crossings crossings_of(const RectangleShape& s, const Ray& ray) {
  const Vector3d o = s.frame.local(ray.origin_mm - s.frame.origin_mm);
  const Vector3d d = s.frame.local(ray.direction);
  const double t = -o.z() / d.z();
  const bool is_hit =
      std::abs(o.x() + t * d.x()) <= s.half_x_mm && std::abs(o.y() + t * d.y()) <= s.half_y_mm;
  if (!is_hit) {
    return {};
  }
  return {ShapeCrossing{.distance_mm = t, .cosine = -d.z()}, std::nullopt};
}

bool is_before(const RectangleShape& s, const Vector3d& point_mm) {
  return (point_mm - s.frame.origin_mm).dot(s.frame.z) > 0.0;
}

// --- ring
// -----------------------------------------------------------------------------------------

/// A point at the distance s from the middle radius along the slope.
ShapePoint ring_point(const RingShape& ring, double along_mm, double phi_rad) {
  const double c = std::cos(ring.tilt_rad);
  const double s = std::sin(ring.tilt_rad);
  const Vector3d radial = std::cos(phi_rad) * ring.frame.x + std::sin(phi_rad) * ring.frame.y;
  return {.point_mm = ring.frame.origin_mm + (ring.middle_radius_mm + along_mm * c) * radial +
                      along_mm * s * ring.frame.z,
          .normal = c * ring.frame.z - s * radial};
}

double area_of(const RingShape& s) {
  return s.span_rad * s.width_mm * s.middle_radius_mm;
}

// The circle's length grows with middle + s cos(tilt): s solves
// middle (s + w / 2) + cos (s^2 - w^2 / 4) / 2 = u middle w, written without cancellation.
ShapePoint point_of(const RingShape& s, double u, double v) {
  const double c = std::cos(s.tilt_rad);
  const double m = s.middle_radius_mm;
  const double q = m * s.width_mm * (u - 0.5) + c * s.width_mm * s.width_mm / 8.0;
  const double along = 2.0 * q / (m + std::sqrt(std::max(0.0, m * m + 2.0 * c * q)));
  return ring_point(s, along, s.first_rad + v * s.span_rad);
}

bool in_sector(const RingShape& s, double x, double y) {
  if (s.span_rad >= 2.0 * kPi) {
    return true;
  }
  const double turns = (std::atan2(y, x) - s.first_rad) / (2.0 * kPi);
  return (turns - std::floor(turns)) * 2.0 * kPi <= s.span_rad;
}

AlignedBox3d box_of(const RingShape& s) {
  const double half_height = 0.5 * s.width_mm * std::abs(std::sin(s.tilt_rad));
  AlignedBox3d box;
  const auto extend = [&](double phi_rad) {
    for (const double radius : {s.inner_radius_mm(), s.outer_radius_mm()}) {
      const double x = radius * std::cos(phi_rad);
      const double y = radius * std::sin(phi_rad);
      box.extend(Vector3d(x, y, -half_height));
      box.extend(Vector3d(x, y, half_height));
    }
  };
  extend(s.first_rad);
  extend(s.first_rad + s.span_rad);
  // Between the ends the circle reaches furthest where it crosses an axis.
  const double quarter = kPi / 2.0;
  double phi = std::ceil(s.first_rad / quarter) * quarter;
  for (int i = 0; i < 4 && phi <= s.first_rad + s.span_rad; ++i, phi += quarter) {
    extend(phi);
  }
  return global_box(s.frame, box);
}

NormalCone cone_of(const RingShape& s) {
  const double sine = std::sin(s.tilt_rad);
  const double cosine = std::cos(s.tilt_rad);
  const double half = std::min(0.5 * s.span_rad, kPi);
  const double about_middle =
      std::acos(std::clamp(cosine * cosine + sine * sine * std::cos(half), -1.0, 1.0));
  if (about_middle < std::abs(s.tilt_rad)) {
    return {.axis = ring_point(s, 0.0, s.first_rad + half).normal, .half_angle_rad = about_middle};
  }
  return {.axis = s.frame.z, .half_angle_rad = std::abs(s.tilt_rad)};
}

/// The crossing at t, when it lies on the ring and not on the rest of the cone.
std::optional<ShapeCrossing> ring_crossing(const RingShape& ring,
                                           const Vector3d& o,
                                           const Vector3d& d,
                                           double t) {
  const double c = std::cos(ring.tilt_rad);
  const double s = std::sin(ring.tilt_rad);
  const double m = ring.middle_radius_mm;
  if (!std::isfinite(t) || ((o.z() + t * d.z()) * c + m * s) * s < 0.0) {
    return std::nullopt;
  }
  // Squaring the cone's equation costs digits; two steps of Newton's method on it bring them back.
  for (int step = 0; step < 2 && std::abs(s) > kFlat_rad; ++step) {
    const Vector3d p = o + t * d;
    const double r = std::max(std::hypot(p.x(), p.y()), 1e-300);
    const double slope = d.z() * c - s * (p.x() * d.x() + p.y() * d.y()) / r;
    if (slope != 0.0) {
      t -= (p.z() * c - (r - m) * s) / slope;
    }
  }
  const Vector3d p = o + t * d;
  const double r = std::hypot(p.x(), p.y());
  const double along = (r - m) * c + p.z() * s;
  if (!(std::abs(along) <= 0.5 * ring.width_mm) || !in_sector(ring, p.x(), p.y())) {
    return std::nullopt;
  }
  const Vector3d radial = r > 0.0 ? Vector3d(p.x() / r, p.y() / r, 0.0) : Vector3d::UnitX();
  return ShapeCrossing{.distance_mm = t, .cosine = s * radial.dot(d) - c * d.z()};
}

Crossings crossings_of(const RingShape& ring, const Ray& ray) {
  const Vector3d o = ring.frame.local(ray.origin_mm - ring.frame.origin_mm);
  const Vector3d d = ring.frame.local(ray.direction);
  if (std::abs(ring.tilt_rad) <= kFlat_rad) {
    return {ring_crossing(ring, o, d, -o.z() / d.z()), std::nullopt};
  }
  const double c = std::cos(ring.tilt_rad);
  const double s = std::sin(ring.tilt_rad);
  const double height = o.z() * c + ring.middle_radius_mm * s;
  const auto t = roots(d.z() * d.z() * c * c - s * s * (d.x() * d.x() + d.y() * d.y()),
                       d.z() * c * height - s * s * (o.x() * d.x() + o.y() * d.y()),
                       height * height - s * s * (o.x() * o.x() + o.y() * o.y()));
  return {ring_crossing(ring, o, d, t[0]), ring_crossing(ring, o, d, t[1])};
}

bool is_before(const RingShape& s, const Vector3d& point_mm) {
  return std::abs(s.tilt_rad) > kFlat_rad || (point_mm - s.frame.origin_mm).dot(s.frame.z) > 0.0;
}

// --- cap
// ------------------------------------------------------------------------------------------

double area_of(const CapShape& s) {
  return 2.0 * kPi * s.radius_mm * s.radius_mm * (std::cos(s.top_rad) - std::cos(s.rim_rad));
}

ShapePoint point_of(const CapShape& s, double u, double v) {
  const double z = std::cos(s.top_rad) + u * (std::cos(s.rim_rad) - std::cos(s.top_rad));
  const double r = std::sqrt(std::max(0.0, (1.0 - z) * (1.0 + z)));
  const double phi = 2.0 * kPi * v;
  const Vector3d out = s.frame.global({r * std::cos(phi), r * std::sin(phi), z});
  return {.point_mm = s.frame.origin_mm + s.radius_mm * out, .normal = -out};
}

AlignedBox3d box_of(const CapShape& s) {
  const bool has_equator = s.top_rad <= kPi / 2.0 && s.rim_rad >= kPi / 2.0;
  const double wide = has_equator ? 1.0 : std::max(std::sin(s.top_rad), std::sin(s.rim_rad));
  const Vector3d low(-wide, -wide, std::cos(s.rim_rad));
  const Vector3d high(wide, wide, std::cos(s.top_rad));
  return global_box(s.frame, AlignedBox3d(s.radius_mm * low, s.radius_mm * high));
}

NormalCone cone_of(const CapShape& s) {
  return {.axis = -s.frame.z, .half_angle_rad = s.rim_rad};
}

Crossings crossings_of(const CapShape& s, const Ray& ray) {
  const Vector3d o = s.frame.local(ray.origin_mm - s.frame.origin_mm);
  const Vector3d d = s.frame.local(ray.direction);
  const auto t = roots(1.0, o.dot(d), o.squaredNorm() - s.radius_mm * s.radius_mm);
  Crossings found;
  for (std::size_t i = 0; i < 2; ++i) {
    const Vector3d p = (o + t[i] * d) / s.radius_mm;
    if (p.z() <= std::cos(s.top_rad) && p.z() >= std::cos(s.rim_rad)) {
      found[i] = ShapeCrossing{.distance_mm = t[i], .cosine = p.dot(d)};
    }
  }
  return found;
}

// A point outside sees the inside of the far wall; only beyond the plane that touches the sphere
// at the apex is nothing seen, which is not worth a test.
bool is_before(const CapShape& /*s*/, const Vector3d& /*point_mm*/) {
  return true;
}

// --- triangle
// -------------------------------------------------------------------------------------

Vector3d wide_normal(const TriangleShape& s) {
  return (s.b_mm - s.a_mm).cross(s.c_mm - s.a_mm);
}

double area_of(const TriangleShape& s) {
  return 0.5 * wide_normal(s).norm();
}

ShapePoint point_of(const TriangleShape& s, double u, double v) {
  const double root = std::sqrt(u);
  const Vector3d p = (1.0 - root) * s.a_mm + root * (1.0 - v) * s.b_mm + root * v * s.c_mm;
  return {.point_mm = p, .normal = wide_normal(s).normalized()};
}

AlignedBox3d box_of(const TriangleShape& s) {
  return AlignedBox3d(s.a_mm).extend(s.b_mm).extend(s.c_mm);
}

NormalCone cone_of(const TriangleShape& s) {
  return {.axis = wide_normal(s).normalized(), .half_angle_rad = 0.0};
}

Crossings crossings_of(const TriangleShape& s, const Ray& ray) {
  const Vector3d normal = wide_normal(s);
  const double slope = normal.dot(ray.direction);
  const double t = normal.dot(s.a_mm - ray.origin_mm) / slope;
  const Vector3d p = ray.origin_mm + t * ray.direction;
  const bool is_hit = normal.dot((s.b_mm - s.a_mm).cross(p - s.a_mm)) >= 0.0 &&
                      normal.dot((s.c_mm - s.b_mm).cross(p - s.b_mm)) >= 0.0 &&
                      normal.dot((s.a_mm - s.c_mm).cross(p - s.c_mm)) >= 0.0;
  if (!is_hit) {
    return {};
  }
  return {ShapeCrossing{.distance_mm = t, .cosine = -slope / normal.norm()}, std::nullopt};
}

bool is_before(const TriangleShape& s, const Vector3d& point_mm) {
  return wide_normal(s).dot(point_mm - s.a_mm) > 0.0;
}

}  // namespace

double RingShape::inner_radius_mm() const {
  return std::max(0.0, middle_radius_mm - 0.5 * width_mm * std::cos(tilt_rad));
}

double RingShape::outer_radius_mm() const {
  return middle_radius_mm + 0.5 * width_mm * std::cos(tilt_rad);
}

// Source: T. Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1), 2017.
EmitterFrame frame_around(const Vector3d& origin_mm, const Vector3d& z) {
  const double sign = std::copysign(1.0, z.z());
  const double a = -1.0 / (sign + z.z());
  const double b = z.x() * z.y() * a;
  return {.origin_mm = origin_mm,
          .x = {1.0 + sign * z.x() * z.x() * a, sign * b, -sign * z.x()},
          .y = {b, sign + z.y() * z.y() * a, -z.y()},
          .z = z};
}

double area_mm2(const EmitterShape& shape) {
  return std::visit([](const auto& s) { return area_of(s); }, shape);
}

ShapePoint point_on(const EmitterShape& shape, double u, double v) {
  return std::visit([u, v](const auto& s) { return point_of(s, u, v); }, shape);
}

AlignedBox3d bounds_mm(const EmitterShape& shape) {
  return std::visit([](const auto& s) { return box_of(s); }, shape);
}

NormalCone normal_cone(const EmitterShape& shape) {
  return std::visit([](const auto& s) { return cone_of(s); }, shape);
}

std::optional<ShapeCrossing> cross(const EmitterShape& shape,
                                   const Ray& ray,
                                   double max_mm,
                                   bool fronts_only) {
  const auto all = std::visit([&ray](const auto& s) { return crossings_of(s, ray); }, shape);
  return nearest(all, max_mm, fronts_only);
}

bool shows_front(const EmitterShape& shape, const Vector3d& point_mm) {
  return std::visit([&point_mm](const auto& s) { return is_before(s, point_mm); }, shape);
}

}  // namespace glint
