// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/planning/planned_cell.h"

#include <cmath>

#include <fmt/format.h>

#include "core/rng.h"
#include "tests/hardware/robot/cell_robot_settings.h"

namespace glint {
namespace {

using Eigen::Vector3d;

SolidBody named(SolidBody body, const char* name, SolidBody::Kind kind, int link) {
  body.name = name;
  body.kind = kind;
  body.link = link;
  return body;
}

SolidBody box_body(const Vector3d& centre_mm, const Vector3d& size_mm) {
  SolidBody body;
  body.mesh = box_mesh(centre_mm, size_mm);
  return body;
}

/// Straight bars around the optical axis.
void add_ring(PlanningCell& cell, double radius_mm, double z_mm) {
  constexpr int kBars = 8;
  const auto corner = [&](int i) {
    const double angle = 2.0 * kPi * i / kBars;
    return Vector3d(cell.flange_from_camera *
                    Vector3d(radius_mm * std::cos(angle), radius_mm * std::sin(angle), z_mm));
  };
  for (int i = 0; i < kBars; ++i) {
    cell.carried.push_back(named(
        capsule_body(corner(i), corner(i + 1), 6.0), "ring light", SolidBody::Kind::kCarried, 6));
  }
}

}  // namespace

TriangleMesh ball_mesh(const Vector3d& centre_mm, double radius_mm, int rows) {
  const int columns = 2 * rows;
  TriangleMesh mesh;
  for (int i = 0; i <= rows; ++i) {
    for (int k = 0; k < columns; ++k) {
      const double polar = kPi * i / rows;
      const double angle = 2.0 * kPi * k / columns;
      mesh.vertices_mm.emplace_back(centre_mm +
                                    radius_mm * Vector3d(std::sin(polar) * std::cos(angle),
                                                         std::sin(polar) * std::sin(angle),
                                                         std::cos(polar)));
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < columns; ++k) {
      const int a = i * columns + k;
      const int b = i * columns + (k + 1) % columns;
      mesh.triangles.push_back({a, a + columns, b});
      mesh.triangles.push_back({b, a + columns, b + columns});
    }
  }
  weld(mesh);
  return mesh;
}

PlanningCell planned_cell() {
  const UrSettings robot = test_robot(ArmModel::kUr3);
  MotionLimits limits = test_limits();
  limits.box_min_mm = {-500.0, -500.0, -100.0};
  limits.box_max_mm = {600.0, 500.0, 800.0};
  PlanningCell cell = {.arm = arm_with_tool(robot, limits)};
  cell.arm.flange_from_tcp = Eigen::Translation3d(0.0, 0.0, 20.0) * Eigen::Isometry3d::Identity();
  cell.flange_from_camera = Eigen::Isometry3d::Identity();
  cell.flange_from_camera.translation() = Vector3d(0.0, 50.0, 30.0);
  cell.carried.push_back(named(box_body(Vector3d(0.0, 50.0, 15.0), Vector3d(40.0, 40.0, 50.0)),
                               "camera",
                               SolidBody::Kind::kCarried,
                               6));
  add_ring(cell, 45.0, 30.0);
  cell.standing.push_back({.name = "part", .mesh = ball_mesh({300.0, 0.0, 60.0}, 40.0, 24)});
  cell.standing.push_back(
      {.name = "post", .mesh = box_mesh({300.0, 150.0, 100.0}, {30.0, 30.0, 200.0})});
  cell.table_mm = 0.0;
  const double d = kRadPerDeg;
  cell.safe_positions = {
      {.name = "above",
       .joints_rad = JointVector{8.873, -82.466, -92.57, -94.964, 90.0, -81.127} * d},
      {.name = "back", .joints_rad = JointVector{8.873, -90.0, -60.0, -120.0, 90.0, 0.0} * d}};
  return cell;
}

Eigen::Isometry3d camera_looking(const Vector3d& target_mm,
                                 const Vector3d& towards,
                                 double distance_mm,
                                 double roll_rad) {
  const Vector3d z = towards.normalized();
  const Vector3d side = std::abs(z.z()) < 0.99 ? Vector3d::UnitZ() : Vector3d::UnitY();
  const Vector3d x = side.cross(z).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = target_mm - distance_mm * z;
  return pose * Eigen::AngleAxisd(roll_rad, Vector3d::UnitZ());
}

ViewRequest random_view(std::uint64_t index) {
  Rng rng(31, Stream::kTest, index);
  const double polar = rng.uniform(0.0, 1.0);
  const double azimuth = rng.uniform(-kPi, kPi);
  const Vector3d towards(
      std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), -std::cos(polar));
  const Vector3d target_mm(
      300.0 + rng.uniform(-30.0, 30.0), rng.uniform(-30.0, 30.0), 60.0 + rng.uniform(-30.0, 30.0));
  const double distance_mm = rng.uniform(60.0, 200.0);
  return {
      .name = fmt::format("view_{}", index + 1),
      .base_from_camera = camera_looking(target_mm, towards, distance_mm, rng.uniform(-kPi, kPi)),
      .target_mm = distance_mm};
}

}  // namespace glint
