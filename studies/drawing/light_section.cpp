// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/light_section.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <variant>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kArcPoints = 48;
constexpr std::size_t kMaxTriangles = 4000;  ///< of mesh emitters that are drawn

Vector3d centre_of(const EmitterShape& shape) {
  return bounds_mm(shape).center();
}

/// The two directions from an axis that lie in the plane; none where the plane is met head-on.
std::vector<Vector3d> radials(const DrawingPlane& section, const EmitterFrame& frame) {
  const Vector3d radial = section.normal().cross(frame.z);
  if (radial.norm() < 1e-6) {
    return {};
  }
  return {radial.normalized(), -radial.normalized()};
}

bool is_in_span(const EmitterFrame& frame,
                const Vector3d& radial,
                double first_rad,
                double span_rad) {
  const double turn = 2.0 * kPi;
  double azimuth = std::atan2(radial.dot(frame.y), radial.dot(frame.x)) - first_rad;
  azimuth -= turn * std::floor(azimuth / turn + 1e-12);
  return azimuth <= span_rad + 1e-9;
}

/// Whether the plane passes near the middle of a round light.
bool is_cut(const DrawingPlane& section, const EmitterFrame& frame, double radius_mm) {
  return std::abs(section.normal().dot(frame.origin_mm - section.origin_mm)) < radius_mm;
}

void add_lines(const RingShape& ring, const DrawingPlane& section, LightLines& lines) {
  if (!is_cut(section, ring.frame, 0.5 * ring.outer_radius_mm())) {
    return;
  }
  for (const Vector3d& radial : radials(section, ring.frame)) {
    if (!is_in_span(ring.frame, radial, ring.first_rad, ring.span_rad)) {
      continue;
    }
    const Vector3d middle = ring.frame.origin_mm + ring.middle_radius_mm * radial;
    const Vector3d slope =
        std::cos(ring.tilt_rad) * radial + std::sin(ring.tilt_rad) * ring.frame.z;
    lines.cut.push_back({section(middle - 0.5 * ring.width_mm * slope),
                         section(middle + 0.5 * ring.width_mm * slope)});
  }
}

void add_lines(const CapShape& cap, const DrawingPlane& section, LightLines& lines) {
  if (!is_cut(section, cap.frame, cap.radius_mm)) {
    return;
  }
  for (const Vector3d& radial : radials(section, cap.frame)) {
    PlaneLine arc;
    for (int i = 0; i <= kArcPoints; ++i) {
      const double angle = cap.top_rad + (cap.rim_rad - cap.top_rad) * i / kArcPoints;
      arc.push_back(section(cap.frame.origin_mm + cap.radius_mm * (std::cos(angle) * cap.frame.z +
                                                                   std::sin(angle) * radial)));
    }
    lines.cut.push_back(arc);
  }
}

void add_lines(const RectangleShape& shape, const DrawingPlane& section, LightLines& lines) {
  PlaneLine outline;
  for (const auto& [x, y] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
    outline.push_back(section(shape.frame.origin_mm + x * shape.half_x_mm * shape.frame.x +
                              y * shape.half_y_mm * shape.frame.y));
  }
  lines.seen.push_back(outline);
}

void add_lines(const TriangleShape& shape, const DrawingPlane& section, LightLines& lines) {
  if (lines.seen.size() < kMaxTriangles) {
    lines.seen.push_back({section(shape.a_mm), section(shape.b_mm), section(shape.c_mm)});
  }
}

/// Round lights that the plane does not meet are seen from the side.
void add_outline(const EmitterShape& shape, const DrawingPlane& section, LightLines& lines) {
  const Eigen::AlignedBox3d box = bounds_mm(shape);
  Vector2d low = Vector2d::Constant(1e300);
  Vector2d high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector2d at = section(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  lines.seen.push_back({low, {high.x(), low.y()}, high, {low.x(), high.y()}});
}

}  // namespace

DrawingPlane drawing_plane(const PhysicalScene& scene) {
  const RigidTransform from_camera = inverse(scene.camera_from_world);
  DrawingPlane section = {.origin_mm = from_camera.translation_mm};
  const Vector3d view = from_camera.rotation.col(2);
  const Vector2d level = view.head<2>();
  if (level.norm() > 0.05) {
    section.across = Vector3d(level.x(), level.y(), 0.0).normalized();
    const bool is_x = std::abs(section.across.x()) > 1.0 - 1e-9;
    const bool is_y = std::abs(section.across.y()) > 1.0 - 1e-9;
    section.across_name = is_x ? "x" : is_y ? "y" : "horizontal";
    if (is_x || is_y) {
      section.across = section.across.cwiseAbs();
    }
    return section;
  }
  Vector2d spread = Vector2d::Zero();
  for (const Emitter& emitter : scene.lights.emitters) {
    spread += (centre_of(emitter.shape) - section.origin_mm).head<2>().cwiseAbs();
  }
  if (spread.x() > 1.2 * spread.y()) {
    section.across = Vector3d::UnitX();
    section.across_name = "x";
  }
  return section;
}

LightLines light_lines_in(const PhysicalScene& scene, const DrawingPlane& section) {
  LightLines lines;
  std::set<int> drawn;
  const std::vector<Emitter>& emitters = scene.lights.emitters;
  for (const Emitter& emitter : emitters) {
    const std::size_t before = lines.cut.size() + lines.seen.size();
    std::visit([&](const auto& shape) { add_lines(shape, section, lines); }, emitter.shape);
    if (lines.cut.size() + lines.seen.size() > before) {
      drawn.insert(emitter.group);
    }
  }
  for (const Emitter& emitter : emitters) {
    if (!drawn.contains(emitter.group)) {
      add_outline(emitter.shape, section, lines);
    }
  }
  return lines;
}

PlaneLine part_outline(const TriangleMesh& mesh, const DrawingPlane& section) {
  constexpr int kDirections = 180;
  std::vector<Vector2d> directions;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2.0 * kPi * k / kDirections;
    directions.emplace_back(std::cos(angle), std::sin(angle));
  }
  PlaneLine hull(kDirections, Vector2d::Zero());
  std::vector<double> farthest(kDirections, -1e300);
  for (const Vector3d& vertex : mesh.vertices_mm) {
    const Vector2d at = section(vertex);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      if (const double reach = at.dot(directions[k]); reach > farthest[k]) {
        farthest[k] = reach;
        hull[k] = at;
      }
    }
  }
  return hull;
}

}  // namespace glint
