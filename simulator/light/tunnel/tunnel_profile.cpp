// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cross-sections of the tunnel in double: how they follow from their settings, and where a line
// meets them, by bisection and without any trick. Tests compare the fast kernels with these
// functions, and results that need no speed use them directly. The free cross-section is evaluated
// by de Boor's recursion (C. de Boor, "A Practical Guide to Splines", 1978) and kept as cubic
// pieces. docs/theory/tunnel.md. Cost: 60 to 100 evaluations of the curve per line.
#include "simulator/light/tunnel/tunnel_profile.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;

Vector2d point_at(const SplineSegment& segment, double u) {
  return {cubic_at(segment.y, u), cubic_at(segment.z, u)};
}

/// Evaluates a B-spline by de Boor's recursion on the knot span [knots[k], knots[k + 1]].
Vector2d de_boor(const std::vector<Vector2d>& control,
                 const std::vector<double>& knots,
                 std::size_t k,
                 double x) {
  std::array<Vector2d, 4> d;
  for (std::size_t j = 0; j < 4; ++j) {
    d[j] = control[k - 3 + j];
  }
  for (std::size_t r = 1; r <= 3; ++r) {
    for (std::size_t j = 3; j >= r; --j) {
      const double low = knots[j + k - 3];
      const double high = knots[j + 1 + k - r];
      const double a = (x - low) / (high - low);
      d[j] = (1.0 - a) * d[j - 1] + a * d[j];
    }
  }
  return d[3];
}

/// The cubic through four values at u = 0, 1/3, 2/3, 1, in powers of u.
void interpolate_cubic(const std::array<double, 4>& f, double* c) {
  c[0] = f[0];
  c[1] = -5.5 * f[0] + 9.0 * f[1] - 4.5 * f[2] + f[3];
  c[2] = 9.0 * f[0] - 22.5 * f[1] + 18.0 * f[2] - 4.5 * f[3];
  c[3] = -4.5 * f[0] + 13.5 * f[1] - 13.5 * f[2] + 4.5 * f[3];
}

}  // namespace

std::vector<FlatWall> flat_walls(double distance_mm,
                                 double opening_rad,
                                 double panel_height_mm,
                                 double base_mm) {
  const double sine = std::sin(0.5 * opening_rad);
  const double cosine = std::cos(0.5 * opening_rad);
  const double to_middle = sine > 1e-12 ? distance_mm / sine : panel_height_mm;
  std::vector<FlatWall> walls;
  for (const double side : {-1.0, 1.0}) {
    FlatWall wall;
    wall.normal_y = side * cosine;
    wall.normal_z = sine;
    wall.start_y_mm = side * distance_mm;
    wall.start_z_mm = base_mm;
    wall.along_y = -side * sine;
    wall.along_z = cosine;
    wall.offset_mm = wall.normal_y * wall.start_y_mm + wall.normal_z * wall.start_z_mm;
    wall.length_mm = std::min(panel_height_mm, to_middle);
    walls.push_back(wall);
  }
  return walls;
}

std::vector<SplineSegment> free_segments(const std::vector<double>& control_mm, double base_mm) {
  GLINT_CHECK(control_mm.size() >= 3, "a cubic needs four control points, mirrored from three");
  const std::size_t half = control_mm.size() - 1;
  std::vector<Vector2d> control;
  for (std::size_t i = 0; i <= 2 * half; ++i) {
    const double radius = control_mm[i <= half ? i : 2 * half - i];
    const double angle = 0.5 * kPi * (static_cast<double>(i) / static_cast<double>(half) - 1.0);
    const double y = i == half ? 0.0 : radius * std::sin(angle);
    const bool is_rim = i == 0 || i == 2 * half;
    control.emplace_back(y, base_mm + (is_rim ? 0.0 : radius * std::cos(angle)));
  }
  const std::size_t num_segments = control.size() - 3;
  std::vector<double> knots(3, 0.0);
  for (std::size_t i = 0; i <= num_segments; ++i) {
    knots.push_back(static_cast<double>(i));
  }
  knots.insert(knots.end(), 3, static_cast<double>(num_segments));
  std::vector<SplineSegment> segments(num_segments);
  for (std::size_t s = 0; s < num_segments; ++s) {
    std::array<double, 4> y = {};
    std::array<double, 4> z = {};
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector2d p =
          de_boor(control, knots, s + 3, static_cast<double>(s) + static_cast<double>(k) / 3.0);
      y[k] = p.x();
      z[k] = p.y();
    }
    interpolate_cubic(y, segments[s].y);
    interpolate_cubic(z, segments[s].z);
  }
  return segments;
}

std::vector<SplineSegment> with_straight_ends(const std::vector<SplineSegment>& segments) {
  constexpr double kLength_mm = 2e3;
  const auto straight = [](const Vector2d& from, const Vector2d& to) {
    const Vector2d along = to - from;
    return SplineSegment{.y = {from.x(), along.x(), 0, 0}, .z = {from.y(), along.y(), 0, 0}};
  };
  const SplineSegment& first = segments.front();
  const SplineSegment& last = segments.back();
  const Vector2d start = point_at(first, 0.0);
  const Vector2d end = point_at(last, 1.0);
  const Vector2d tangent_at_start = Vector2d(first.y[1], first.z[1]).normalized();
  const Vector2d tangent_at_end = Vector2d(last.y[1] + 2.0 * last.y[2] + 3.0 * last.y[3],
                                           last.z[1] + 2.0 * last.z[2] + 3.0 * last.z[3])
                                      .normalized();
  std::vector<SplineSegment> extended = {straight(start - kLength_mm * tangent_at_start, start)};
  extended.insert(extended.end(), segments.begin(), segments.end());
  extended.push_back(straight(end, end + kLength_mm * tangent_at_end));
  return extended;
}

std::vector<Vector2d> sample_spline(const std::vector<SplineSegment>& segments, int num_points) {
  std::vector<Vector2d> points;
  const auto count = static_cast<int>(segments.size());
  for (int i = 0; i < num_points; ++i) {
    const double at = static_cast<double>(i) * count / (num_points - 1);
    const int s = std::min(count - 1, static_cast<int>(at));
    points.push_back(point_at(segments[static_cast<std::size_t>(s)], at - s));
  }
  return points;
}

namespace {

constexpr int kQuarter = (kProfilePoints - 1) / 2;
static_assert(2 * kQuarter + 1 == kProfilePoints);

/// Sines at equal angles of the first quarter of a circle, its ends exact.
std::vector<double> quarter_sines() {
  std::vector<double> sines;
  for (int i = 0; i <= kQuarter; ++i) {
    sines.push_back(std::sin(0.5 * kPi * i / kQuarter));
  }
  return sines;
}

}  // namespace

std::vector<Vector2d> sample_superellipse(const EllipseAxes& axes,
                                          double exponent,
                                          double base_mm) {
  static const std::vector<double> sines = quarter_sines();
  const double power = 2.0 / exponent;
  std::vector<double> raised;
  for (const double sine : sines) {
    raised.push_back(power == 1.0 ? sine : std::pow(sine, power));
  }
  const auto of_quarter = [&](int i) { return raised[static_cast<std::size_t>(i)]; };
  std::vector<Vector2d> points;
  points.reserve(kProfilePoints);
  for (int i = 0; i < kProfilePoints; ++i) {
    const int from_end = std::min(i, kProfilePoints - 1 - i);
    const double y = std::copysign(of_quarter(kQuarter - from_end), i - kQuarter);
    const double z = of_quarter(from_end);
    points.emplace_back(axes.half_width_mm * y, base_mm + axes.height_mm * z);
  }
  return points;
}

std::optional<double> hit_walls(const std::vector<FlatWall>& walls,
                                const Vector2d& origin,
                                const Vector2d& direction,
                                double min_t) {
  std::optional<double> nearest;
  for (const FlatWall& wall : walls) {
    const Vector2d normal(wall.normal_y, wall.normal_z);
    const double slope = normal.dot(direction);
    const double t = (wall.offset_mm - normal.dot(origin)) / slope;
    const Vector2d from_start = origin + t * direction - Vector2d(wall.start_y_mm, wall.start_z_mm);
    const double along = from_start.dot(Vector2d(wall.along_y, wall.along_z));
    if (slope > 0.0 && t > min_t && along >= 0.0 && along <= wall.length_mm &&
        (!nearest || t < *nearest)) {
      nearest = t;
    }
  }
  return nearest;
}

std::optional<double> hit_segments(const std::vector<SplineSegment>& segments,
                                   const Vector2d& origin,
                                   const Vector2d& direction,
                                   double min_t) {
  const Vector2d normal(direction.y(), -direction.x());
  std::optional<double> nearest;
  for (const SplineSegment& segment : segments) {
    const auto side = [&](double u) { return normal.dot(point_at(segment, u) - origin); };
    double low = 0.0;
    double high = 1.0;
    const bool starts_left = side(low) <= 0.0;
    if (starts_left == (side(high) <= 0.0)) {
      continue;
    }
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      ((side(middle) <= 0.0) == starts_left ? low : high) = middle;
    }
    const double t =
        (point_at(segment, 0.5 * (low + high)) - origin).dot(direction) / direction.squaredNorm();
    if (t > min_t && (!nearest || t < *nearest)) {
      nearest = t;
    }
  }
  return nearest;
}

std::optional<double> hit_superellipse_exact(const EllipseAxes& axes,
                                             double exponent,
                                             double base_mm,
                                             const Vector2d& origin,
                                             const Vector2d& direction,
                                             double min_t) {
  const Vector2d scale(1.0 / axes.half_width_mm, 1.0 / axes.height_mm);
  const Vector2d p = (origin - Vector2d(0.0, base_mm)).cwiseProduct(scale);
  const Vector2d v = direction.cwiseProduct(scale);
  const auto value = [&](double t) {
    return std::pow(std::abs(p.x() + t * v.x()), exponent) +
           std::pow(std::abs(p.y() + t * v.y()), exponent) - 1.0;
  };
  if (!(v.norm() > 0.0) || value(0.0) >= 0.0) {
    return std::nullopt;  // along the tunnel, or from outside
  }
  // Inside the convex curve there is exactly one exit; bracket it and bisect.
  double low = 0.0;
  double high = 2.0 * (1.0 + p.norm()) / v.norm();
  for (int step = 0; step < 100; ++step) {
    const double middle = 0.5 * (low + high);
    (value(middle) < 0.0 ? low : high) = middle;
  }
  const bool is_upper = p.y() + high * v.y() >= 0.0;
  return high > min_t && is_upper ? std::optional(high) : std::nullopt;
}

}  // namespace glint
