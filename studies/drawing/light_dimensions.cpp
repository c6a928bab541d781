// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/light_dimensions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "core/text.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInPlane = 0.02;    ///< sine of the largest angle to the plane
constexpr double kSame_mm = 1e-3;    ///< dimensions that differ by less are one
constexpr double kLevel_deg = 0.05;  ///< sides at less are level, or upright
constexpr std::size_t kMinLeds = 3;  ///< that tell the circle they stand on
constexpr double kDiscShare = 1e-6;  ///< inner radius of a disc, of its outer one

/// A circle in space.
struct Circle {
  Vector3d centre_mm = Vector3d::Zero();
  Vector3d axis = Vector3d::UnitZ();
  double radius_mm = 0.0;
};

/// What the emitters of one light have in common.
struct LightShapes {
  std::vector<Circle> circles;
  std::vector<Vector3d> leds_mm;       ///< middles of discs
  std::vector<RectangleShape> pieces;  ///< of a bar
  Eigen::AlignedBox3d box_mm;
  std::optional<Vector3d> rim_mm;  ///< middle of a dome's rim, from where its height is told

  Vector3d place_mm() const { return rim_mm ? *rim_mm : Vector3d(box_mm.center()); }
};

void add(const RingShape& ring, LightShapes& shapes) {
  if (ring.inner_radius_mm() <= kDiscShare * ring.outer_radius_mm()) {
    shapes.leds_mm.push_back(ring.frame.origin_mm);
    return;
  }
  // The outer edge lies forwards, where the front of the tilted ring turns inwards.
  for (const double side : {1.0, -1.0}) {
    const double half = 0.5 * side * ring.width_mm;
    shapes.circles.push_back(
        {.centre_mm = ring.frame.origin_mm + half * std::sin(ring.tilt_rad) * ring.frame.z,
         .axis = ring.frame.z,
         .radius_mm = ring.middle_radius_mm + half * std::cos(ring.tilt_rad)});
  }
}

void add(const CapShape& cap, LightShapes& shapes) {
  shapes.rim_mm =
      cap.frame.origin_mm + cap.radius_mm * std::cos(cap.rim_rad) * Vector3d(cap.frame.z);
  for (const double angle : {std::min(cap.rim_rad, 0.5 * kPi), cap.top_rad}) {
    shapes.circles.push_back(
        {.centre_mm = cap.frame.origin_mm + cap.radius_mm * std::cos(angle) * cap.frame.z,
         .axis = cap.frame.z,
         .radius_mm = cap.radius_mm * std::sin(angle)});
  }
}

void add(const RectangleShape& rectangle, LightShapes& shapes) {
  shapes.pieces.push_back(rectangle);
}

void add(const TriangleShape& /*triangle*/, LightShapes& /*shapes*/) {}

/// The circle on which LEDs stand that are spread evenly over it.
void add_led_circle(LightShapes& shapes) {
  const std::vector<Vector3d>& leds = shapes.leds_mm;
  if (leds.size() < kMinLeds) {
    return;
  }
  Vector3d centre = Vector3d::Zero();
  for (const Vector3d& led : leds) {
    centre += led / static_cast<double>(leds.size());
  }
  const Vector3d axis = (leds[0] - centre).cross(leds[1] - centre);
  if (axis.norm() > 0.0) {
    shapes.circles.push_back(
        {.centre_mm = centre, .axis = axis.normalized(), .radius_mm = (leds[0] - centre).norm()});
  }
}

/// "y -178.6 mm"
std::string coordinate_text(const std::string& axis, double place_mm) {
  return fmt::format("{} {}{}", axis, place_mm < 0.0 ? "-" : "", length_text(std::abs(place_mm)));
}

class Dimensions {
 public:
  explicit Dimensions(const DrawingPlane& plane) : plane_(plane) {}

  void add_circle(const Circle& circle) {
    const Vector3d radial = plane_.normal().cross(circle.axis);
    const bool is_seen = std::abs(plane_.normal().dot(circle.axis)) < kInPlane;
    if (!is_seen || circle.radius_mm <= kSame_mm) {
      return;
    }
    const Vector3d half = circle.radius_mm * radial.normalized();
    add_between(circle.centre_mm - half,
                circle.centre_mm + half,
                "\u00d8 " + length_text(2.0 * circle.radius_mm));
  }

  /// From one end of a bar to the other, along one of its sides.
  void add_side(const std::vector<RectangleShape>& pieces, bool is_length) {
    const EmitterFrame& frame = pieces.front().frame;
    const Vector3d along = is_length ? frame.x : frame.y;
    if (std::abs(plane_.normal().dot(along)) >= kInPlane) {
      return;
    }
    double low = 0.0;
    double high = 0.0;
    for (const RectangleShape& piece : pieces) {
      const double at = along.dot(piece.frame.origin_mm - frame.origin_mm);
      const double half = is_length ? piece.half_x_mm : piece.half_y_mm;
      low = std::min(low, at - half);
      high = std::max(high, at + half);
    }
    add_between(frame.origin_mm + low * along,
                frame.origin_mm + high * along,
                length_text(high - low) + inclination(along));
  }

  /// How far a light stands aside of the origin.
  void add_aside(const Vector3d& middle_mm) {
    const Vector2d middle = plane_(middle_mm);
    const Vector2d below_origin(0.0, middle.y());
    if (std::abs(middle.x()) > kSame_mm) {
      const bool is_left = middle.x() < 0.0;
      add(is_left ? middle : below_origin,
          is_left ? below_origin : middle,
          coordinate_text(plane_.across_name, middle.x()));
    }
  }

  /// From the level of the origin up to a light.
  void add_height(const Vector3d& middle_mm) {
    const Vector2d middle = plane_(middle_mm);
    const Vector2d level(middle.x(), 0.0);
    if (std::abs(middle.y()) > kSame_mm) {
      const bool is_below = middle.y() < 0.0;
      add(is_below ? middle : level, is_below ? level : middle, coordinate_text("z", middle.y()));
    }
  }

  std::vector<PlaneDimension> take() { return std::move(list_); }

 private:
  /// " at 45 deg", of a side that is neither level nor upright in the plane.
  std::string inclination(const Vector3d& along) const {
    const Vector2d side = plane_(plane_.origin_mm + along) - plane_(plane_.origin_mm);
    const double angle_deg = std::atan2(std::abs(side.y()), std::abs(side.x())) * kDegPerRad;
    const bool is_oblique = angle_deg > kLevel_deg && angle_deg < 90.0 - kLevel_deg;
    return is_oblique ? fmt::format(" at {:.3g}\u00b0", angle_deg) : std::string();
  }

  void add_between(const Vector3d& a_mm, const Vector3d& b_mm, std::string words) {
    Vector2d a = plane_(a_mm);
    Vector2d b = plane_(b_mm);
    if (a.x() > b.x() + kSame_mm || (a.x() > b.x() - kSame_mm && a.y() > b.y())) {
      std::swap(a, b);
    }
    add(a, b, std::move(words));
  }

  void add(const Vector2d& a, const Vector2d& b, std::string words) {
    const bool is_known = std::ranges::any_of(list_, [&](const PlaneDimension& one) {
      return one.words == words && (one.a_mm - a).norm() < kSame_mm &&
             (one.b_mm - b).norm() < kSame_mm;
    });
    if (!is_known && (b - a).norm() > kSame_mm) {
      list_.push_back({.a_mm = a, .b_mm = b, .words = std::move(words)});
    }
  }

  const DrawingPlane& plane_;
  std::vector<PlaneDimension> list_;
};

/// "ring.3" is a segment of "ring".
std::string light_of(const LightGroup& group) {
  return group.name.substr(0, group.name.find('.'));
}

}  // namespace

std::vector<PlaneDimension> light_dimensions(const PhysicalScene& scene,
                                             const DrawingPlane& plane) {
  std::map<std::string, LightShapes> lights;
  for (const Emitter& emitter : scene.lights.emitters) {
    if (scene.lights.is_of_wall(emitter.group)) {
      continue;  // wall_plan.h has the tunnel's wall
    }
    LightShapes& shapes =
        lights[light_of(scene.lights.groups[static_cast<std::size_t>(emitter.group)])];
    std::visit([&](const auto& shape) { add(shape, shapes); }, emitter.shape);
    shapes.box_mm.extend(bounds_mm(emitter.shape));
  }
  Dimensions dimensions(plane);
  for (auto& [name, shapes] : lights) {
    add_led_circle(shapes);
    for (const Circle& circle : shapes.circles) {
      dimensions.add_circle(circle);
    }
    const bool is_bar = !shapes.pieces.empty() && shapes.circles.empty();
    if (is_bar) {
      dimensions.add_side(shapes.pieces, true);
      dimensions.add_side(shapes.pieces, false);
    }
    if (is_bar || !shapes.circles.empty()) {
      dimensions.add_aside(shapes.place_mm());
      dimensions.add_height(shapes.place_mm());
    }
  }
  return dimensions.take();
}

}  // namespace glint
