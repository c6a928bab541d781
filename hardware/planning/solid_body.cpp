// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/solid_body.h"

#include <array>
#include <utility>

#include "hardware/robot/kinematics/link_shapes.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kWidthMm = 1e-3;  ///< of a segment's triangle, which must not be degenerate

/// Which link moves each capsule of arm_shape(): elbow and wrist 1 lie along the axis of the joint
/// after them and belong to the link before it.
constexpr std::array<int, kLinkNames.size()> kLinkOf = {1, 2, 2, 3, 3, 4, 5, 6};

Vector3d across(const Vector3d& direction) {
  const Vector3d other =
      std::abs(direction.z()) < 0.9 * direction.norm() ? Vector3d::UnitZ() : Vector3d::UnitX();
  return direction.norm() > 0.0 ? Vector3d(direction.cross(other).normalized()) : Vector3d::UnitY();
}

}  // namespace

SolidBody capsule_body(const Vector3d& from_mm, const Vector3d& to_mm, double radius_mm) {
  const bool is_ball = (to_mm - from_mm).norm() < kWidthMm;
  const Vector3d end_mm = is_ball ? Vector3d(from_mm + kWidthMm * Vector3d::UnitX()) : to_mm;
  SolidBody body;
  body.mesh.vertices_mm = {
      from_mm, end_mm, 0.5 * (from_mm + end_mm) + kWidthMm * across(end_mm - from_mm)};
  body.mesh.triangles = {{0, 1, 2}};
  body.radius_mm = radius_mm;
  return body;
}

TriangleMesh box_mesh(const Vector3d& centre_mm, const Vector3d& size_mm) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner(
        (i & 1) != 0 ? 0.5 : -0.5, (i & 2) != 0 ? 0.5 : -0.5, (i & 4) != 0 ? 0.5 : -0.5);
    mesh.vertices_mm.emplace_back(centre_mm + corner.cwiseProduct(size_mm));
  }
  mesh.triangles = {{0, 2, 1},
                    {1, 2, 3},
                    {4, 5, 6},
                    {5, 7, 6},
                    {0, 1, 4},
                    {1, 5, 4},
                    {2, 6, 3},
                    {3, 6, 7},
                    {0, 4, 2},
                    {2, 4, 6},
                    {1, 3, 5},
                    {3, 7, 5}};
  return mesh;
}

std::vector<SolidBody> arm_bodies(const ArmWithTool& arm) {
  const JointVector zero_rad = JointVector::Zero();
  const LinkFrames frames = arm.arm.frames(zero_rad);
  const ArmShape shape = arm_shape(arm.arm, zero_rad, arm.flange_from_tcp, arm.tool_radius_mm);
  SolidBody base = capsule_body(Vector3d::Zero(), frames[1].translation(), shape.front().radius_mm);
  base.name = "base";
  base.kind = SolidBody::Kind::kBase;
  std::vector<SolidBody> bodies = {std::move(base)};
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Eigen::Isometry3d link_from_base =
        frames.at(static_cast<std::size_t>(kLinkOf[i])).inverse();
    SolidBody body = capsule_body(
        link_from_base * shape[i].from_mm, link_from_base * shape[i].to_mm, shape[i].radius_mm);
    body.name = kLinkNames[i];
    body.kind = i + 1 == shape.size() ? SolidBody::Kind::kTool : SolidBody::Kind::kArm;
    body.link = kLinkOf[i];
    bodies.push_back(std::move(body));
  }
  return bodies;
}

std::vector<Vector3d> hull_of(const TriangleMesh& mesh) {
  constexpr std::size_t kFew = 8;
  if (mesh.vertices_mm.size() <= kFew) {
    return mesh.vertices_mm;
  }
  const BoundingBox box = bounding_box(mesh);
  return box_mesh(box.centre_mm(), box.size_mm()).vertices_mm;
}

}  // namespace glint
