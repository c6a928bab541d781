// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/spherical_sampling.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double safe_sqrt(double value) {
  return std::sqrt(std::max(0.0, value));
}

/// The angle at corner a between the great circles to b and to c.
double corner_angle_rad(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d to_b = a.cross(b);
  const Vector3d to_c = a.cross(c);
  return std::atan2(to_b.cross(to_c).norm(), to_b.dot(to_c));
}

/// The part of v across unit a, unit; zero when they are parallel.
Vector3d across(const Vector3d& v, const Vector3d& a) {
  const Vector3d rest = v - v.dot(a) * a;
  const double length = rest.norm();
  return length > 0.0 ? Vector3d(rest / length) : Vector3d::Zero();
}

}  // namespace

// The planes through the eye and the sides have the normals (0, z, -y0), (-z, 0, x1), (0, -z, y1),
// (z, 0, -x0); the angles between neighbours are those of the spherical rectangle.
SphericalRectangle::SphericalRectangle(
    double x0_mm, double x1_mm, double y0_mm, double y1_mm, double z_mm)
    : x0_(x0_mm), x1_(x1_mm), y0_(y0_mm), y1_(y1_mm), z_(-std::abs(z_mm)) {
  const double n0 = -y0_ / std::hypot(z_, y0_);
  const double n1 = x1_ / std::hypot(z_, x1_);
  const double n2 = y1_ / std::hypot(z_, y1_);
  const double n3 = -x0_ / std::hypot(z_, x0_);
  const auto angle = [](double p, double q) { return std::acos(std::clamp(-p * q, -1.0, 1.0)); };
  b0_ = n0;
  b1_ = n2;
  k_ = 2.0 * kPi - angle(n2, n3) - angle(n3, n0);
  solid_angle_sr_ = std::max(0.0, angle(n0, n1) + angle(n1, n2) - k_);
}

Vector2d SphericalRectangle::point_mm(double u, double v) const {
  const double au = u * solid_angle_sr_ + k_;
  const double fu = (std::cos(au) * b0_ - b1_) / std::sin(au);
  const double cu = std::clamp(std::copysign(1.0, fu) / std::hypot(fu, b0_), -1.0, 1.0);
  const double xu = std::clamp(-(cu * z_) / std::max(safe_sqrt(1.0 - cu * cu), 1e-300), x0_, x1_);
  const double d = std::hypot(xu, z_);
  const double h0 = y0_ / std::hypot(d, y0_);
  const double h1 = y1_ / std::hypot(d, y1_);
  const double hv = h0 + v * (h1 - h0);
  const double yv = hv * d / std::max(safe_sqrt(1.0 - hv * hv), 1e-300);
  return {xu, std::clamp(yv, y0_, y1_)};
}

double triangle_solid_angle_sr(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double triple = std::abs(a.dot(b.cross(c)));
  return 2.0 * std::atan2(triple, 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
}

Vector3d sample_spherical_triangle(
    const Vector3d& a, const Vector3d& b, const Vector3d& c, double u, double v) {
  const double area = u * triangle_solid_angle_sr(a, b, c);
  const double alpha = corner_angle_rad(a, b, c);
  const double sin_alpha = std::sin(alpha);
  const double cos_alpha = std::cos(alpha);
  const double s = std::sin(area - alpha);
  const double t = std::cos(area - alpha);
  const double p = t - cos_alpha;
  const double q = s + sin_alpha * a.dot(b);
  // The corner c' on the arc from a to c for which the triangle a b c' has the wanted area.
  const double above = (q * t - p * s) * cos_alpha - q;
  const double below = (q * s + p * t) * sin_alpha;
  const double cos_side = below != 0.0 ? std::clamp(above / below, -1.0, 1.0) : 1.0;
  const Vector3d corner = cos_side * a + safe_sqrt(1.0 - cos_side * cos_side) * across(c, a);
  // A point on the arc from b to c', uniform in height over b.
  const double fall = v * (1.0 - corner.dot(b));
  const double z = 1.0 - fall;
  return (z * b + safe_sqrt(fall * (1.0 + z)) * across(corner, b)).normalized();
}

}  // namespace glint
