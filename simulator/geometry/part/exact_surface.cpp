// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/exact_surface.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Value and gradient of F in the patch frame.
struct Implicit {
  double value_mm = 0.0;
  Vector3d gradient = Vector3d::Zero();
};

Implicit implicit(const PlanePatch&, const Vector3d& p) {
  return {.value_mm = p.z(), .gradient = Vector3d::UnitZ()};
}

/// Infinite radii give a slope of exactly zero.
Implicit implicit(const ParaboloidPatch& patch, const Vector3d& p) {
  const double slope_x = p.x() / patch.radius_along_mm;
  const double slope_y = p.y() / patch.radius_across_mm;
  return {.value_mm = p.z() + 0.5 * (p.x() * slope_x + p.y() * slope_y),
          .gradient = Vector3d(slope_x, slope_y, 1.0)};
}

Implicit implicit(const SpherePatch& patch, const Vector3d& p) {
  const double r = p.norm();
  return {.value_mm = r - patch.radius_mm,
          .gradient = r > 0.0 ? Vector3d(p / r) : Vector3d::Zero()};
}

Implicit implicit(const CylinderPatch& patch, const Vector3d& p) {
  const double r = std::sqrt(p.y() * p.y() + p.z() * p.z());
  const double sign = patch.is_bore ? -1.0 : 1.0;
  const Vector3d radial(0.0, p.y(), p.z());
  return {.value_mm = sign * (r - patch.radius_mm),
          .gradient = r > 0.0 ? Vector3d(sign * radial / r) : Vector3d::Zero()};
}

/// F = r_b (inv(T) - hand (phi - start)) with the roll angle T of the tangent through p,
/// T = sqrt(r^2 - r_b^2) / r_b, inv(T) = T - atan T: the distance along the normal of the involute,
/// all of whose normals touch the base circle (docs/theory/parts.md).
Implicit implicit(const InvolutePatch& patch, const Vector3d& p) {
  const double r = std::sqrt(p.y() * p.y() + p.z() * p.z());
  if (r <= 0.0) {
    return {};
  }
  const double base = patch.base_radius_mm;
  const double tangent = std::sqrt(std::max(0.0, r * r - base * base));
  const double roll = tangent / base;
  const double turned = std::atan2(p.z(), p.y()) - patch.start_rad;
  const double phi =
      patch.hand * (std::abs(turned) <= kPi ? turned : std::remainder(turned, 2.0 * kPi));
  const Vector3d e_r(0.0, p.y() / r, p.z() / r);
  const Vector3d e_phi(0.0, -e_r.z(), e_r.y());
  return {.value_mm = base * (roll - std::atan(roll) - phi),
          .gradient = (tangent / r) * e_r - (patch.hand * base / r) * e_phi};
}

Implicit evaluate(const ExactPatch& patch, const Vector3d& p_in_patch) {
  return std::visit([&](const auto& shape) { return implicit(shape, p_in_patch); }, patch.shape);
}

using Kind = PatchCoefficients::Kind;

void set_shape(const PlanePatch&, PatchCoefficients& c) {
  c.kind = Kind::kPlane;
}

void set_shape(const ParaboloidPatch& patch, PatchCoefficients& c) {
  c.kind = Kind::kParaboloid;
  c.curvature_along = 1.0 / patch.radius_along_mm;
  c.curvature_across = 1.0 / patch.radius_across_mm;
}

void set_shape(const SpherePatch& patch, PatchCoefficients& c) {
  c.kind = Kind::kSphere;
  c.radius_mm = patch.radius_mm;
}

void set_shape(const CylinderPatch& patch, PatchCoefficients& c) {
  c.kind = Kind::kCylinder;
  c.radius_mm = patch.radius_mm;
  c.outwards = patch.is_bore ? -1.0 : 1.0;
}

void set_shape(const InvolutePatch& patch, PatchCoefficients& c) {
  c.kind = Kind::kInvolute;
  c.radius_mm = patch.base_radius_mm;
  c.hand = patch.hand;
}

/// The frame in which the kernel's shape has the numbers above: that of the patch, but for an
/// involute turned so that it starts on the y axis.
Eigen::Matrix3d kernel_rotation(const ExactPatch& patch) {
  const auto* involute = std::get_if<InvolutePatch>(&patch.shape);
  if (involute == nullptr) {
    return patch.scene_from_patch.rotation;
  }
  const double c = std::cos(involute->start_rad);
  const double s = std::sin(involute->start_rad);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.bottomRightCorner<2, 2>() << c, -s, s, c;
  return patch.scene_from_patch.rotation * turn;
}

}  // namespace

PatchCoefficients coefficients_of(const ExactPatch& patch) {
  PatchCoefficients c;
  std::visit([&](const auto& shape) { set_shape(shape, c); }, patch.shape);
  const Eigen::Matrix3d rotation = kernel_rotation(patch);
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 3; ++column) {
      c.rotation[3 * row + column] = rotation(row, column);
    }
    c.translation[row] = patch.scene_from_patch.translation_mm[row];
  }
  return c;
}

double implicit_value(const ExactPatch& patch, const Vector3d& p_mm, Vector3d* gradient) {
  const Eigen::Matrix3d& rotation = patch.scene_from_patch.rotation;
  const Vector3d p_in_patch = rotation.transpose() * (p_mm - patch.scene_from_patch.translation_mm);
  const Implicit result = evaluate(patch, p_in_patch);
  if (gradient != nullptr) {
    *gradient = rotation * result.gradient;
  }
  return result.value_mm;
}

std::optional<SurfaceHit> polish(const ExactPatch& patch,
                                 const Ray& ray,
                                 double start_t_mm,
                                 double max_move_mm) {
  const Eigen::Matrix3d& rotation = patch.scene_from_patch.rotation;
  const Vector3d direction = rotation.transpose() * ray.direction;
  const Vector3d start = rotation.transpose() * (ray.origin_mm + start_t_mm * ray.direction -
                                                 patch.scene_from_patch.translation_mm);
  double move_mm = 0.0;
  // Steps below the rounding of the coordinates cannot get smaller: 1e-12 at 1 m is 5 units.
  const double tolerance_mm = kPolished_mm * std::max(1.0, 1e-2 * start.norm());
  for (int i = 0; i < kMaxPolishSteps; ++i) {
    const Implicit f = evaluate(patch, start + move_mm * direction);
    const double slope = f.gradient.dot(direction);
    const double step_mm = -f.value_mm / slope;
    move_mm += step_mm;
    if (!(std::abs(move_mm) <= max_move_mm)) {  // also when the slope is zero
      return std::nullopt;
    }
    if (std::abs(step_mm) <= tolerance_mm) {
      const Implicit at_hit = evaluate(patch, start + move_mm * direction);
      const double t_mm = start_t_mm + move_mm;
      return SurfaceHit{.t_mm = t_mm,
                        .point_mm = rotation * (start + move_mm * direction) +
                                    patch.scene_from_patch.translation_mm,
                        .normal = rotation * at_hit.gradient.normalized()};
    }
  }
  return std::nullopt;
}

}  // namespace glint
