// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/lay.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "core/pose.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<std::string_view, 4> kLayKinds = {"none", "turned", "brushed", "milled"};

/// The mill's edge at its front runs through the point: a circle whose centre lies behind, on the
/// middle of the lane.
Vector2d milled(const LaySettings& settings, const Vector2d& at_mm) {
  const double lane = settings.lane_mm;
  const double across_mm = at_mm.y() - lane * std::round(at_mm.y() / lane);
  const double radius_mm = settings.mill_radius_mm;
  const double ahead_mm =
      std::sqrt(std::max(0.0, (radius_mm - across_mm) * (radius_mm + across_mm)));
  return Vector2d(-across_mm, ahead_mm) / radius_mm;
}

}  // namespace

void visit_keys(KeyVisitor& keys, LaySettings& s) {
  const Count three = {.min = 3, .max = 3};
  const Range length = Range::between(-1e5, 1e5);
  keys.choice("kind", s.kind, kLayKinds, "which way the grooves of machining run");
  keys.numbers(
      "center_mm", s.center_mm, three, length, "a point of the axis, or of a lane's middle");
  keys.numbers("axis", s.axis, three, length, "turned, milled: the axis of lathe or mill");
  keys.numbers("direction", s.direction, three, length, "brushed, milled: of brushing or feed");
  keys.number("mill_radius_mm", s.mill_radius_mm, {.min = 0.1, .max = 1e4}, "milled: of the mill");
  keys.number(
      "lane_mm", s.lane_mm, {.min = 0.1, .max = 2e4}, "milled: between passes side by side");
  keys.require(s.lane_mm <= 2.0 * s.mill_radius_mm,
               "lane_mm",
               "is wider than the mill; must be at most 2 mill_radius_mm");
  const Vector3d axis = vector_of(s.axis);
  const Vector3d direction = vector_of(s.direction);
  keys.require(axis.norm() > 0.0, "axis", "is zero; must have a length");
  keys.require(axis.cross(direction).norm() > 1e-6 * axis.norm() * direction.norm(),
               "direction",
               "is zero or along the axis; must lie across it");
}

LayPlane plane_of(const LaySettings& settings) {
  const Vector3d axis = vector_of(settings.axis).normalized();
  const ShadingFrame frame = frame_at(axis, vector_of(settings.direction));
  return {.center_mm = vector_of(settings.center_mm),
          .u = frame.tangent,
          .v = frame.bitangent,
          .axis = axis};
}

Vector3d groove_at(const LaySettings& settings, const LayPlane& plane, const Vector3d& point_mm) {
  Vector2d groove = Vector2d::UnitX();
  if (settings.kind == LaySettings::Kind::kTurned) {
    const Vector2d at_mm = plane.at(point_mm);
    const double radius_mm = at_mm.norm();
    groove = radius_mm > 0.0 ? Vector2d(-at_mm.y(), at_mm.x()) / radius_mm : Vector2d(0.0, 0.0);
  } else if (settings.kind == LaySettings::Kind::kMilled) {
    groove = milled(settings, plane.at(point_mm));
  }
  return plane.u * groove.x() + plane.v * groove.y();
}

}  // namespace glint
