// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives by the shape of the wall. A wall that moves by nu along its normal n moves the hit of
// a ray with direction d by nu / (n . d) along the ray, whatever the key (implicit
// differentiation). In reverse mode: the derivatives by all hits are collected once at 2,049 nodes
// of the wall (four sums for flat panels), and a key then costs the sum over the nodes of its own
// nu. Nodes lie closer near the top and the feet, where normals of a superellipse vary as powers.
// docs/theory/derivatives.md, "Wall". Cost: one pass over the rays, then 2,049 terms per key.
#include "simulator/light/tunnel/shape_derivative.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/error.h"
#include "simulator/light/tunnel/spline_kernels.h"
#include "simulator/light/tunnel/tunnel_profile.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Shape = TunnelSettings::Shape;

constexpr std::size_t kNodes = 2048;

/// A camera in the middle plane of a roof sees its ridge with a whole row of rays. They leave it to
/// either side when the camera moves: their derivative is the mean of both, as a central difference
/// has it.
constexpr double kRidge_mm = 1e-7;

constexpr std::array<std::string_view, 8> kKeys = {"base_mm",
                                                   "radius_mm",
                                                   "half_width_mm",
                                                   "height_mm",
                                                   "exponent",
                                                   "distance_mm",
                                                   "opening_deg",
                                                   "panel_height_mm"};

/// The direction of a node from the base line (WallNormals).
Vector2d direction_of(std::size_t node) {
  const double side = -1.0 + 2.0 * static_cast<double>(node) / static_cast<double>(kNodes);
  const double from_top = std::abs(side);
  const double root = std::min(from_top, 1.0 - from_top);
  const double minimum = 2.0 * root * root;
  const bool is_upper = from_top < 0.5;
  return {std::copysign(is_upper ? minimum : 1.0 - minimum, side),
          is_upper ? 1.0 - minimum : minimum};
}

/// Which control point a key like "control_mm.2" names; -1: none.
int control_index(std::string_view key) {
  constexpr std::string_view kName = "control_mm.";
  int index = -1;
  if (key.starts_with(kName)) {
    std::from_chars(key.data() + kName.size(), key.data() + key.size(), index);
  }
  return index;
}

double cubic_derivative(const double* c, double u) {
  return c[1] + u * (2.0 * c[2] + u * 3.0 * c[3]);
}

/// A superellipse's half axes and exponent.
struct HalfAxes {
  double a, b, e;
};

HalfAxes superellipse_of(const TunnelSettings& s) {
  if (s.shape == Shape::kSemicylinder) {
    return {s.radius_mm, s.radius_mm, 2.0};
  }
  return {s.half_width_mm, s.height_mm, s.shape == Shape::kSuperellipse ? s.exponent : 2.0};
}

/// The point of a superellipse in a node's direction, in half axes.
Vector2d scaled_point(const HalfAxes& s, std::size_t node) {
  const Vector2d along = direction_of(node);
  const double y = std::abs(along.x()) / s.a;
  const double z = along.y() / s.b;
  const double r = std::pow(std::pow(y, s.e) + std::pow(z, s.e), -1.0 / s.e);
  return {std::copysign(r * y, along.x()), r * z};
}

/// Gradient of F = |y / a|^e + |z / b|^e - 1.
Vector2d gradient_at(const HalfAxes& s, const Vector2d& scaled) {
  return {std::copysign(s.e / s.a * std::pow(std::abs(scaled.x()), s.e - 1.0), scaled.x()),
          s.e / s.b * std::pow(scaled.y(), s.e - 1.0)};
}

/// Where a function that rises through 0 in [0, 1] does, to 1e-12, by false position with the
/// weight of an end that stays halved (the Illinois method); an end where it does not.
template <class Function>
double rising_root(const Function& f) {
  double low = 0.0, high = 1.0;
  double at_low = f(low), at_high = f(high);
  if (at_low >= 0.0 || at_high <= 0.0) {
    return at_low >= 0.0 ? low : high;
  }
  constexpr int kMaxSteps = 40;
  double last = 2.0;
  std::optional<bool> was_low;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double u = low + (high - low) * at_low / (at_low - at_high);
    const double here = f(u);
    if (here == 0.0 || std::abs(u - last) < 1e-12) {
      return u;
    }
    last = u;
    const bool is_low = here < 0.0;
    const double stays = is_low == was_low ? 0.5 : 1.0;
    (is_low ? low : high) = u;
    at_low = is_low ? here : stays * at_low;
    at_high = is_low ? stays * at_high : here;
    was_low = is_low;
  }
  return 0.5 * (low + high);
}

/// The same for a cubic, by Newton's method from a place nearby.
double rising_root(const std::array<double, 4>& c, double near) {
  const auto f = [&](double u) { return cubic_at(c.data(), u); };
  if (f(0.0) >= 0.0 || f(1.0) <= 0.0) {
    return f(0.0) >= 0.0 ? 0.0 : 1.0;
  }
  constexpr int kMaxSteps = 8;
  constexpr double kLastStep = 1e-7;  // the error after a step goes as its square
  double u = near;
  for (int step = 0; step < kMaxSteps && u >= 0.0 && u <= 1.0; ++step) {
    const double move = -f(u) / cubic_derivative(c.data(), u);
    u += move;
    if (std::abs(move) < kLastStep && u >= 0.0 && u <= 1.0) {
      return u;
    }
  }
  return rising_root(f);
}

double value(const float* array, int i) {
  return array != nullptr ? static_cast<double>(array[i]) : 0.0;
}

}  // namespace

ShapeDerivative::ShapeDerivative(const Tunnel& tunnel) : settings_(tunnel.settings()) {
  switch (settings_.shape) {
    case Shape::kFlat:
      build_flat();
      break;
    case Shape::kFree:
      build_free();
      break;
    default:
      build_superellipse();
  }
  by_node_.assign(normals_.size(), 0.0);
  for (const Vector2d& normal : normals_) {
    normals_y_.push_back(static_cast<float>(normal.x()));
    normals_z_.push_back(static_cast<float>(normal.y()));
  }
}

void ShapeDerivative::build_superellipse() {
  const HalfAxes s = superellipse_of(settings_);
  for (std::size_t i = 0; i <= kNodes; ++i) {
    normals_.push_back(gradient_at(s, scaled_point(s, i)).normalized());
  }
}

/// The curve turns around the base line in one direction: pieces and places grow with the nodes.
void ShapeDerivative::build_free() {
  const std::vector<SplineSegment> segments =
      free_segments(settings_.control_mm, settings_.base_mm);
  std::size_t segment = 0;
  double u = 0.0;
  for (std::size_t i = 0; i <= kNodes; ++i) {
    const Vector2d along = direction_of(i);
    const auto side = [&] {
      const SplineSegment& s = segments[segment];
      std::array<double, 4> c;
      for (std::size_t power = 0; power < c.size(); ++power) {
        c[power] = s.y[power] * along.y() - s.z[power] * along.x();
      }
      c[0] += settings_.base_mm * along.x();
      return c;
    };
    while (segment + 1 < segments.size() && cubic_at(side().data(), 1.0) < 0.0) {
      ++segment;
      u = 0.0;
    }
    u = rising_root(side(), u);
    const Vector2d tangent =
        Vector2d(cubic_derivative(segments[segment].y, u), cubic_derivative(segments[segment].z, u))
            .normalized();
    normals_.emplace_back(-tangent.y(), tangent.x());
    segments_.push_back(segment);
    places_.push_back(u);
  }
}

void ShapeDerivative::build_flat() {
  const TunnelSettings& s = settings_;
  is_flat_ = true;
  wall_ = flat_walls(s.distance_mm, s.opening_rad, s.panel_height_mm, s.base_mm)[1];
  touch_at_top_ = s.panel_height_mm * std::sin(0.5 * s.opening_rad) >= s.distance_mm * (1.0 - 1e-9);
}

/// z of a hit: the margin tells it on curves; on panels the line of the wall does.
double ShapeDerivative::height_of(double y_mm,
                                  double margin_mm,
                                  const RayBlock& rays,
                                  int i) const {
  if (!is_flat_) {
    return settings_.base_mm + margin_mm;
  }
  const double sign = y_mm < 0.0 ? -1.0 : 1.0;
  const Vector2d o(sign * value(rays.origin_y, i), value(rays.origin_z, i));
  const Vector2d d(sign * value(rays.direction_y, i), value(rays.direction_z, i));
  const Vector2d normal(wall_.normal_y, wall_.normal_z);
  return o.y() + (wall_.offset_mm - normal.dot(o)) / normal.dot(d) * d.y();
}

ShapeDerivative::Place ShapeDerivative::place_of(double y_mm, double margin_mm, double z_mm) const {
  Place place;
  if (is_flat_) {
    const double sign = y_mm < 0.0 ? -1.0 : 1.0;
    place.part = (std::abs(y_mm) - wall_.start_y_mm) * wall_.along_y +
                 (z_mm - wall_.start_z_mm) * wall_.along_z;
    place.normal = Vector2d(sign * wall_.normal_y, wall_.normal_z);
    place.is_near_top = !touch_at_top_ && wall_.length_mm - place.part < place.part;
    place.margin_gradient =
        (place.is_near_top ? -1.0 : 1.0) * Vector2d(sign * wall_.along_y, wall_.along_z);
    return place;
  }
  const double height = std::max(0.0, margin_mm);
  const double beside = std::abs(y_mm);
  const double root = std::sqrt(0.5 * std::min(beside, height) / std::max(1e-9, beside + height));
  const double side = std::copysign(beside < height ? root : 1.0 - root, y_mm);
  const double at = 0.5 * (side + 1.0) * static_cast<double>(kNodes);
  place.node = std::min(kNodes - 1, static_cast<std::size_t>(at));
  place.part = at - static_cast<double>(place.node);
  place.normal = (1.0 - place.part) * normals_[place.node] + place.part * normals_[place.node + 1];
  return place;
}

void ShapeDerivative::collect(const RayBlock& rays,
                              const HitBlock& hits,
                              const HitGradient& derivatives) {
  if (is_flat_) {
    collect_flat(rays, hits, derivatives);
  } else {
    collect_curve(rays, hits, derivatives);
  }
}

void ShapeDerivative::collect_flat(const RayBlock& rays,
                                   const HitBlock& hits,
                                   const HitGradient& derivatives) {
  for (int i = 0; i < rays.count; ++i) {
    const double by_x = value(derivatives.x, i);
    const double by_y = value(derivatives.y, i);
    const double by_margin = value(derivatives.margin, i);
    if (by_x == 0.0 && by_y == 0.0 && by_margin == 0.0) {
      continue;
    }
    const double y = value(hits.y_mm, i);
    const double margin = value(hits.margin_mm, i);
    const Place place = place_of(y, margin, height_of(y, margin, rays, i));
    const Vector2d direction(value(rays.direction_y, i), value(rays.direction_z, i));
    const double along_ray = by_x * value(rays.direction_x, i) + by_y * direction.x() +
                             by_margin * place.margin_gradient.dot(direction);
    const double by_shift = along_ray / place.normal.dot(direction);
    by_shift_ += by_shift;
    by_turn_ += by_shift * place.part;
    (place.is_near_top ? by_top_ : by_margin_) += by_margin;
  }
}

void ShapeDerivative::collect_curve(const RayBlock& rays,
                                    const HitBlock& hits,
                                    const HitGradient& derivatives) {
  add_shift_derivatives(
      rays,
      hits.y_mm,
      hits.margin_mm,
      derivatives,
      {.y = normals_y_.data(), .z = normals_z_.data(), .pieces = static_cast<int>(kNodes)},
      by_node_.data());
  if (derivatives.margin != nullptr) {
    by_margin_ += sum_in_lanes(derivatives.margin, rays.count);
  }
}

double ShapeDerivative::superellipse_speed(std::string_view key, std::size_t node) const {
  const HalfAxes s = superellipse_of(settings_);
  const Vector2d scaled = scaled_point(s, node);
  const double size = gradient_at(s, scaled).norm();
  const double y = std::abs(scaled.x());
  const double z = scaled.y();
  const double to_y = std::pow(y, s.e);
  const double to_z = std::pow(z, s.e);
  const auto times_log = [](double power, double x) { return x > 0.0 ? power * std::log(x) : 0.0; };
  const bool is_circle = settings_.shape == Shape::kSemicylinder;
  if (key == "radius_mm" && is_circle) {
    return s.e * (to_y / s.a + to_z / s.b) / size;
  }
  if (key == "half_width_mm" && !is_circle) {
    return s.e * to_y / s.a / size;
  }
  if (key == "height_mm" && !is_circle) {
    return s.e * to_z / s.b / size;
  }
  if (key == "exponent" && settings_.shape == Shape::kSuperellipse) {
    return -(times_log(to_y, y) + times_log(to_z, z)) / size;
  }
  return 0.0;
}

/// nu at each node.
std::vector<double> ShapeDerivative::speeds_of(std::string_view key) const {
  std::vector<double> speeds(normals_.size(), 0.0);
  if (key == "base_mm") {
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      speeds[i] = normals_[i].y();
    }
  } else if (settings_.shape != Shape::kFree) {
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      speeds[i] = superellipse_speed(key, i);
    }
  } else if (const int control = control_index(key);
             control >= 0 && control < static_cast<int>(settings_.control_mm.size())) {
    // The curve is linear in its control points.
    std::vector<double> control_mm = settings_.control_mm;
    const std::vector<SplineSegment> here = free_segments(control_mm, settings_.base_mm);
    control_mm[static_cast<std::size_t>(control)] += 1.0;
    const std::vector<SplineSegment> moved = free_segments(control_mm, settings_.base_mm);
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      const SplineSegment& from = here[segments_[i]];
      const SplineSegment& to = moved[segments_[i]];
      speeds[i] =
          normals_[i].dot(Vector2d(cubic_at(to.y, places_[i]) - cubic_at(from.y, places_[i]),
                                   cubic_at(to.z, places_[i]) - cubic_at(from.z, places_[i])));
    }
  }
  return speeds;
}

double ShapeDerivative::derivative_of_flat(std::string_view key) const {
  const Vector2d along(wall_.along_y, wall_.along_z);
  const Vector2d normal(wall_.normal_y, wall_.normal_z);
  const auto by_foot = [&](const Vector2d& speed) {
    return by_shift_ * normal.dot(speed) - (by_margin_ - by_top_) * along.dot(speed);
  };
  if (key == "distance_mm") {
    return by_foot(Vector2d::UnitX());
  }
  if (key == "base_mm") {
    return by_foot(Vector2d::UnitY());
  }
  if (key == "opening_deg") {
    return -0.5 * by_turn_;
  }
  return key == "panel_height_mm" && !touch_at_top_ ? by_top_ : 0.0;
}

std::optional<double> ShapeDerivative::derivative_by(std::string_view key) const {
  if (std::ranges::find(kKeys, key) == kKeys.end() && control_index(key) < 0) {
    return std::nullopt;
  }
  if (is_flat_) {
    return derivative_of_flat(key);
  }
  const std::vector<double> speeds = speeds_of(key);
  double sum = key == "base_mm" ? -by_margin_ : 0.0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    sum += by_node_[i] * speeds[i];
  }
  return sum;
}

double ShapeDerivative::derivative_by_rays(const RayBlock& rays,
                                           const RayMotion& motion,
                                           const HitBlock& hits,
                                           const HitGradient& derivatives) const {
  double sum = 0.0;
  for (int i = 0; i < rays.count; ++i) {
    const double by_x = value(derivatives.x, i);
    const double by_y = value(derivatives.y, i);
    const double by_margin = value(derivatives.margin, i);
    if (by_x == 0.0 && by_y == 0.0 && by_margin == 0.0) {
      continue;
    }
    const double y = value(hits.y_mm, i);
    const double margin = value(hits.margin_mm, i);
    const double z = height_of(y, margin, rays, i);
    const Place place = place_of(y, margin, z);
    const Eigen::Vector3d origin = vector_of(rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]);
    const Eigen::Vector3d direction =
        vector_of(rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]);
    const Eigen::Vector3d hit(value(hits.x_mm, i), y, z);
    const double t = (hit - origin).dot(direction) / direction.squaredNorm();
    const Eigen::Vector3d moved =
        vector_of(motion.origin_x[i], motion.origin_y[i], motion.origin_z[i]) +
        t * vector_of(motion.direction_x[i], motion.direction_y[i], motion.direction_z[i]);
    const auto derivative_on = [&](double side) {
      const Vector2d normal(side * place.normal.x(), place.normal.y());
      const Vector2d gradient(side * place.margin_gradient.x(), place.margin_gradient.y());
      const double dt = -normal.dot(moved.tail<2>()) / normal.dot(direction.tail<2>());
      const Eigen::Vector3d shift = moved + dt * direction;
      return by_x * shift.x() + by_y * shift.y() + by_margin * gradient.dot(shift.tail<2>());
    };
    const bool is_on_ridge = is_flat_ && std::abs(y) < kRidge_mm;
    sum += is_on_ridge ? 0.5 * (derivative_on(1.0) + derivative_on(-1.0)) : derivative_on(1.0);
  }
  return sum;
}

}  // namespace glint
