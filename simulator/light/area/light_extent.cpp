// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/light_extent.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "simulator/light/area/wall_outline.h"

namespace glint {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// How far a surface reaches along a unit vector, from the origin.
double furthest(const RectangleShape& s, const Vector3d& along) {
  return s.frame.origin_mm.dot(along) + s.half_x_mm * std::abs(s.frame.x.dot(along)) +
         s.half_y_mm * std::abs(s.frame.y.dot(along));
}

double furthest(const TriangleShape& s, const Vector3d& along) {
  return std::max({s.a_mm.dot(along), s.b_mm.dot(along), s.c_mm.dot(along)});
}

/// A ring is ruled between its two edges, so it reaches furthest on one of them.
double furthest(const RingShape& s, const Vector3d& along) {
  const Vector3d to = s.frame.local(along);
  // Around the axis it reaches furthest where it turns towards `to`, or at an end of the sector.
  const double turn = std::atan2(to.y(), to.x()) - s.first_rad;
  const double within = turn - 2.0 * kPi * std::floor(turn / (2.0 * kPi));
  const bool is_inside = within <= s.span_rad;
  const double cosine = is_inside ? 1.0 : std::max(std::cos(turn), std::cos(turn - s.span_rad));
  const double across = std::hypot(to.x(), to.y()) * cosine;
  double reach = -std::numeric_limits<double>::infinity();
  for (const double side : {-0.5, 0.5}) {
    const double radius =
        std::max(0.0, s.middle_radius_mm + side * s.width_mm * std::cos(s.tilt_rad));
    const double height = side * s.width_mm * std::sin(s.tilt_rad);
    reach = std::max(reach, radius * across + height * to.z());
  }
  return s.frame.origin_mm.dot(along) + reach;
}

/// The point of the sphere in that direction, or the nearest that belongs to the cap.
double furthest(const CapShape& s, const Vector3d& along) {
  const Vector3d to = s.frame.local(along);
  const double angle = std::atan2(std::hypot(to.x(), to.y()), to.z());
  const double nearest = std::clamp(angle, s.top_rad, s.rim_rad);
  return s.frame.origin_mm.dot(along) + s.radius_mm * std::cos(nearest - angle);
}

int num_leds(const LightSettings& settings) {
  const auto* ring = std::get_if<RingSettings>(&settings);
  return ring != nullptr ? ring->leds : 0;
}

}  // namespace

AlignedBox3d exact_bounds_mm(const EmitterShape& shape) {
  Vector3d low;
  Vector3d high;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Vector3d along = Vector3d::Unit(axis);
    high[axis] = std::visit([&](const auto& s) { return furthest(s, along); }, shape);
    low[axis] = -std::visit([&](const auto& s) { return furthest(s, -along); }, shape);
  }
  return {low, high};
}

LightExtent extent_of(const std::vector<NamedLight>& lights,
                      const LightMounts& mounts,
                      const MeshLoader& load_mesh) {
  LightExtent extent;
  for (const NamedLight& light : lights) {
    if (std::holds_alternative<EnvironmentSettings>(light.settings)) {
      continue;
    }
    for (const Emitter& emitter : build_lights({light}, mounts, load_mesh).emitters) {
      extent.box_mm.extend(exact_bounds_mm(emitter.shape));
      extent.area_mm2 += area_mm2(emitter.shape);
    }
    extent.leds += num_leds(light.settings);
  }
  return extent;
}

LightExtent extent_of(const TunnelSettings& tunnel, double middle_x_mm) {
  TunnelSettings bright = tunnel;
  bright.dark_reflectance = 0.0;  // costs time and changes no size
  const WallSize wall = wall_size(Tunnel(bright));
  if (wall.length_mm <= 0.0) {
    return {};
  }
  const double half_mm = 0.5 * tunnel.length_mm;
  return {.box_mm = AlignedBox3d(
              Vector3d(middle_x_mm - half_mm, wall.box_yz_mm.min().x(), wall.box_yz_mm.min().y()),
              Vector3d(middle_x_mm + half_mm, wall.box_yz_mm.max().x(), wall.box_yz_mm.max().y())),
          .area_mm2 = wall.length_mm * tunnel.length_mm};
}

LightExtent together(const LightExtent& a, const LightExtent& b) {
  return {.box_mm = a.box_mm.merged(b.box_mm),
          .area_mm2 = a.area_mm2 + b.area_mm2,
          .leds = a.leds + b.leds};
}

}  // namespace glint
