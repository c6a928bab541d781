// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/reference/reference_surface.h"

#include <algorithm>
#include <cmath>

namespace glint::stability {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Shape = ReferencePart::Shape;

constexpr double kReachSigmas = 6.0;
constexpr double kStepsPerSigma = 16.0;

/// Squared distance across x, or from the centre, of spheres and cylinders.
Vector3d round_part(const ReferencePart& part, Vector3d v) {
  if (part.shape == Shape::kCylinder) {
    v.x() = 0.0;
  }
  return v;
}

bool is_on_part(const ReferencePart& part, const Vector3d& p) {
  switch (part.shape) {
    case Shape::kParaboloid:
      return std::abs(p.x()) <= part.half_mm.x() && std::abs(p.y()) <= part.half_mm.y();
    case Shape::kSphere:
      return p.z() >= part.base_z_mm;
    case Shape::kCylinder:
      return std::abs(p.x()) <= part.half_mm.x();
  }
  return false;
}

std::optional<std::array<double, 2>> smooth_roots(const ReferencePart& part,
                                                  const Vector3d& o,
                                                  const Vector3d& d) {
  if (part.shape == Shape::kParaboloid) {
    // z - apex + (bx x^2 + by y^2) / 2 = 0
    const Vector2d bend(part.bend_along, part.bend_across);
    const double a = 0.5 * (bend.x() * d.x() * d.x() + bend.y() * d.y() * d.y());
    const double b = 0.5 * (d.z() + bend.x() * o.x() * d.x() + bend.y() * o.y() * d.y());
    const double c =
        o.z() - part.centre_z_mm + 0.5 * (bend.x() * o.x() * o.x() + bend.y() * o.y() * o.y());
    return quadratic_roots(a, b, c);
  }
  const Vector3d centre(0.0, 0.0, part.centre_z_mm);
  const Vector3d u = round_part(part, d);
  const Vector3d v = round_part(part, o - centre);
  return quadratic_roots(
      u.squaredNorm(), u.dot(v), v.squaredNorm() - part.radius_mm * part.radius_mm);
}

Vector3d smooth_normal(const ReferencePart& part, const Vector3d& p) {
  if (part.shape == Shape::kParaboloid) {
    return Vector3d(part.bend_along * p.x(), part.bend_across * p.y(), 1.0).normalized();
  }
  return round_part(part, p - Vector3d(0.0, 0.0, part.centre_z_mm)).normalized();
}

/// Height of the smooth surface above (x, y); dents lie on the upper side.
double smooth_height(const ReferencePart& part, double x, double y) {
  if (part.shape == Shape::kParaboloid) {
    return part.centre_z_mm - 0.5 * (part.bend_along * x * x + part.bend_across * y * y);
  }
  const double across = y * y + (part.shape == Shape::kSphere ? x * x : 0.0);
  return part.centre_z_mm + std::sqrt(std::max(0.0, part.radius_mm * part.radius_mm - across));
}

/// Sum of the dents' heights and its gradient by x and y.
double dent_height(const ReferencePart& part, double x, double y, Vector2d& gradient) {
  double height = 0.0;
  gradient.setZero();
  for (const ReferenceDent& dent : part.dents) {
    const Vector2d from(x - dent.x_mm, y - dent.y_mm);
    const double s2 = dent.sigma_mm * dent.sigma_mm;
    const double h = dent.height_mm * std::exp(-0.5 * from.squaredNorm() / s2);
    height += h;
    gradient -= h / s2 * from;
  }
  return height;
}

double above(const ReferencePart& part, const Vector3d& p) {
  Vector2d ignored;
  return p.z() - smooth_height(part, p.x(), p.y()) - dent_height(part, p.x(), p.y(), ignored);
}

SurfaceHit hit_at(const ReferencePart& part, const Vector3d& p, bool has_dent) {
  Vector3d normal = smooth_normal(part, p);
  if (has_dent) {
    Vector2d gradient;
    dent_height(part, p.x(), p.y(), gradient);
    normal = (normal / normal.z() - Vector3d(gradient.x(), gradient.y(), 0.0)).normalized();
  }
  return {.point_mm = p + part.position_mm, .normal = normal};
}

/// The dent near a point of the part frame that reaches furthest; null: none.
const ReferenceDent* dent_near(const ReferencePart& part, const Vector3d& p) {
  for (const ReferenceDent& dent : part.dents) {
    const double distance = Vector2d(p.x() - dent.x_mm, p.y() - dent.y_mm).norm();
    if (distance < kReachSigmas * dent.sigma_mm + 4.0 * std::abs(dent.height_mm)) {
      return &dent;
    }
  }
  return nullptr;
}

/// Where the ray first passes from above the displaced surface to below it.
std::optional<double> march(const ReferencePart& part,
                            const Vector3d& o,
                            const Vector3d& d,
                            double from,
                            double to,
                            double step) {
  bool was_above = above(part, o + from * d) > 0.0;
  double t = from;
  while (t < to) {
    const double next = std::min(t + step, to);
    const bool is_above = above(part, o + next * d) > 0.0;
    if (was_above && !is_above) {
      double low = t;
      double high = next;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (above(part, o + middle * d) > 0.0 ? low : high) = middle;
      }
      return 0.5 * (low + high);
    }
    was_above = is_above;
    t += step;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::array<double, 2>> quadratic_roots(double a, double b, double c) {
  if (a == 0.0) {
    return b == 0.0 ? std::nullopt : std::optional(std::array{-0.5 * c / b, -0.5 * c / b});
  }
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) {
    return std::nullopt;
  }
  // The larger of the two sums has no cancellation; the other root is c over it.
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  const double first = q / a;
  const double second = q == 0.0 ? first : c / q;
  return std::array{std::min(first, second), std::max(first, second)};
}

std::optional<SurfaceHit> intersect(const ReferencePart& part,
                                    const Vector3d& origin_mm,
                                    const Vector3d& direction) {
  const Vector3d o = origin_mm - part.position_mm;
  const auto roots = smooth_roots(part, o, direction);
  if (!roots) {
    return std::nullopt;
  }
  for (const double t : *roots) {
    const Vector3d p = o + t * direction;
    if (t <= 0.0 || !is_on_part(part, p) || smooth_normal(part, p).dot(direction) >= 0.0) {
      continue;
    }
    const ReferenceDent* dent = dent_near(part, p);
    if (dent == nullptr) {
      return hit_at(part, p, false);
    }
    const double reach = std::abs(dent->height_mm) / std::abs(direction.z()) + 2.0 * dent->sigma_mm;
    const auto exact =
        march(part, o, direction, t - reach, t + reach, dent->sigma_mm / kStepsPerSigma);
    return hit_at(part, o + exact.value_or(t) * direction, true);
  }
  return std::nullopt;
}

std::optional<SurfaceHit> intersect_again(const ReferencePart& part,
                                          const SurfaceHit& from,
                                          const Vector3d& direction) {
  const Vector3d o = from.point_mm - part.position_mm;
  const ReferenceDent* dent = dent_near(part, o);
  if (dent == nullptr) {
    return std::nullopt;
  }
  const double sigma = dent->sigma_mm;
  const auto t =
      march(part, o, direction, 1e-6 * sigma, 2.0 * kReachSigmas * sigma, sigma / kStepsPerSigma);
  if (!t || !is_on_part(part, o + *t * direction)) {
    return std::nullopt;
  }
  return hit_at(part, o + *t * direction, true);
}

double radii_from(const ReferencePart& part, const ReferenceDent& dent, const Vector3d& point_mm) {
  const Vector3d centre(dent.x_mm, dent.y_mm, smooth_height(part, dent.x_mm, dent.y_mm));
  const Vector3d normal = smooth_normal(part, centre);
  const Vector3d from = point_mm - part.position_mm - centre;
  return (from - from.dot(normal) * normal).norm() / (2.0 * dent.sigma_mm);
}

}  // namespace glint::stability
