// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/shape_sampling.h"

#include <cmath>
#include <limits>

#include "simulator/light/area/spherical_sampling.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Beyond this many diagonals the cosine and the distance hardly change over a surface: drawing
/// from the area costs less and is as good.
constexpr double kFarDiagonals = 4.0;
/// Outside this range of solid angles the closed forms lose their digits.
constexpr double kMinSolidAngle_sr = 1e-4;
constexpr double kMaxSolidAngle_sr = 6.2;

bool is_near(const Vector3d& point_mm, const Vector3d& centre_mm, double diagonal_mm) {
  return (point_mm - centre_mm).squaredNorm() <
         kFarDiagonals * kFarDiagonals * diagonal_mm * diagonal_mm;
}

bool is_good(double solid_angle_sr) {
  return solid_angle_sr > kMinSolidAngle_sr && solid_angle_sr < kMaxSolidAngle_sr;
}

/// The direction to a point of the surface.
std::optional<ShapeSample> towards(const Vector3d& point_mm, const ShapePoint& to, double density) {
  const Vector3d way = to.point_mm - point_mm;
  const double distance = way.norm();
  if (!(distance > 0.0)) {
    return std::nullopt;
  }
  const Vector3d direction = way / distance;
  const double cosine = -direction.dot(to.normal);
  if (!(cosine > 0.0) || !(density > 0.0)) {
    return std::nullopt;
  }
  return ShapeSample{
      .direction = direction, .distance_mm = distance, .cosine = cosine, .density = density};
}

double area_density(double area, const ShapeCrossing& crossing) {
  const double below = area * crossing.cosine;
  return below > 0.0 ? crossing.distance_mm * crossing.distance_mm / below : 0.0;
}

/// As seen from the point, when it is near enough for its solid angle to be drawn from.
std::optional<SphericalRectangle> seen(const RectangleShape& s, const Vector3d& point_mm) {
  if (!is_near(point_mm, s.frame.origin_mm, 2.0 * std::hypot(s.half_x_mm, s.half_y_mm))) {
    return std::nullopt;
  }
  const Vector3d o = s.frame.local(s.frame.origin_mm - point_mm);
  if (o.z() == 0.0) {
    return std::nullopt;
  }
  const SphericalRectangle rectangle(
      o.x() - s.half_x_mm, o.x() + s.half_x_mm, o.y() - s.half_y_mm, o.y() + s.half_y_mm, o.z());
  return is_good(rectangle.solid_angle_sr()) ? std::optional(rectangle) : std::nullopt;
}

struct SeenTriangle {
  Vector3d a, b, c;  ///< unit directions to the corners
  double solid_angle_sr;
};

std::optional<SeenTriangle> seen(const TriangleShape& s, const Vector3d& point_mm) {
  const Vector3d centre = (s.a_mm + s.b_mm + s.c_mm) / 3.0;
  const double size = std::max((s.b_mm - s.a_mm).norm(), (s.c_mm - s.a_mm).norm());
  if (!is_near(point_mm, centre, size)) {
    return std::nullopt;
  }
  SeenTriangle t = {.a = (s.a_mm - point_mm).normalized(),
                    .b = (s.b_mm - point_mm).normalized(),
                    .c = (s.c_mm - point_mm).normalized(),
                    .solid_angle_sr = 0.0};
  t.solid_angle_sr = triangle_solid_angle_sr(t.a, t.b, t.c);
  return is_good(t.solid_angle_sr) ? std::optional(t) : std::nullopt;
}

/// Density of the solid angle; 0 where the area is drawn from.
template <class Shape>
double near_density(const Shape& /*s*/, const Vector3d& /*point_mm*/) {
  return 0.0;
}

template <>
double near_density(const RectangleShape& s, const Vector3d& point_mm) {
  const auto rectangle = seen(s, point_mm);
  return rectangle ? 1.0 / rectangle->solid_angle_sr() : 0.0;
}

template <>
double near_density(const TriangleShape& s, const Vector3d& point_mm) {
  const auto triangle = seen(s, point_mm);
  return triangle ? 1.0 / triangle->solid_angle_sr : 0.0;
}

template <class Shape>
std::optional<ShapeSample> sample_area(const Shape& s,
                                       const Vector3d& point_mm,
                                       double u,
                                       double v) {
  auto sample = towards(point_mm, point_on(s, u, v), 1.0);
  if (sample) {
    sample->density =
        area_density(area_mm2(s), {.distance_mm = sample->distance_mm, .cosine = sample->cosine});
  }
  return sample;
}

template <class Shape>
std::optional<ShapeSample> sample_of(const Shape& s, const Vector3d& point_mm, double u, double v) {
  return sample_area(s, point_mm, u, v);
}

template <>
std::optional<ShapeSample> sample_of(const RectangleShape& s,
                                     const Vector3d& point_mm,
                                     double u,
                                     double v) {
  const auto rectangle = seen(s, point_mm);
  if (!rectangle) {
    return sample_area(s, point_mm, u, v);
  }
  const double height = (s.frame.origin_mm - point_mm).dot(s.frame.z);
  const Vector2d at = rectangle->point_mm(u, v);
  const Vector3d to = point_mm + s.frame.global({at.x(), at.y(), height});
  return towards(
      point_mm, {.point_mm = to, .normal = s.frame.z}, 1.0 / rectangle->solid_angle_sr());
}

template <>
std::optional<ShapeSample> sample_of(const TriangleShape& s,
                                     const Vector3d& point_mm,
                                     double u,
                                     double v) {
  const auto triangle = seen(s, point_mm);
  if (!triangle) {
    return sample_area(s, point_mm, u, v);
  }
  const Vector3d direction = sample_spherical_triangle(triangle->a, triangle->b, triangle->c, u, v);
  const Vector3d normal = (s.b_mm - s.a_mm).cross(s.c_mm - s.a_mm).normalized();
  const double slope = normal.dot(direction);
  const double t = normal.dot(s.a_mm - point_mm) / slope;
  if (!(slope < 0.0) || !(t > 0.0)) {
    return std::nullopt;
  }
  return ShapeSample{.direction = direction,
                     .distance_mm = t,
                     .cosine = -slope,
                     .density = 1.0 / triangle->solid_angle_sr};
}

}  // namespace

std::optional<ShapeSample> sample_shape(const EmitterShape& shape,
                                        const Vector3d& point_mm,
                                        double u,
                                        double v) {
  return std::visit([&](const auto& s) { return sample_of(s, point_mm, u, v); }, shape);
}

double shape_density(const EmitterShape& shape,
                     const Vector3d& point_mm,
                     const ShapeCrossing& crossing) {
  if (!(crossing.cosine > 0.0)) {
    return 0.0;
  }
  const double near = std::visit([&](const auto& s) { return near_density(s, point_mm); }, shape);
  return near > 0.0 ? near : area_density(area_mm2(shape), crossing);
}

}  // namespace glint
