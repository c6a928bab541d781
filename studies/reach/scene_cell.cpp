// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/reach/scene_cell.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/config/toml.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "studies/reach/light_bodies.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Kind = SolidBody::Kind;

constexpr int kFlange = 6;

Vector3d vector_of_three(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

RigidTransform transform_of(const Eigen::Isometry3d& pose) {
  return {.rotation = pose.linear(), .translation_mm = pose.translation()};
}

/// The table [calibration] of a file that glint calibrate wrote.
CalibrationSettings read_calibration_of(const std::filesystem::path& file) {
  const ConfigNode root = load_toml(file);
  std::vector<Problem> errors;
  KeyReader reader(root.find("calibration"), "calibration", errors);
  CalibrationSettings calibration;
  visit_keys(reader, calibration);
  throw_if_any(errors);
  return calibration;
}

RigidTransform scene_from_part(const SceneSettings& scene) {
  return pose_from_angles(vector_of_three(scene.part.position_mm),
                          vector_of_three(scene.part.rotation_rad));
}

void add_camera(const PlanningSettings& settings, PlanningCell& planned) {
  if (settings.camera_size_mm.empty()) {
    return;
  }
  const Vector3d size_mm = vector_of_three(settings.camera_size_mm);
  SolidBody body = {.name = "camera", .kind = Kind::kCarried, .link = kFlange};
  body.mesh = box_mesh(Vector3d(0.0, 0.0, settings.camera_front_mm - 0.5 * size_mm.z()), size_mm);
  transform(body.mesh, transform_of(planned.flange_from_camera));
  planned.carried.push_back(std::move(body));
}

void add_capsule(const std::string& name,
                 const Vector3d& from_mm,
                 const Vector3d& to_mm,
                 double radius_mm,
                 PlanningCell& planned) {
  SolidBody body = capsule_body(from_mm, to_mm, radius_mm);
  body.name = name;
  body.kind = Kind::kCarried;
  body.link = kFlange;
  planned.carried.push_back(std::move(body));
}

void add_carried(const CellPlanning& planning, PlanningCell& planned) {
  add_camera(planning.settings, planned);
  const std::vector<double>& cable = planning.settings.cable_mm;
  for (std::size_t i = 3; i + 2 < cable.size(); i += 3) {
    add_capsule("cable",
                {cable[i - 3], cable[i - 2], cable[i - 1]},
                {cable[i], cable[i + 1], cable[i + 2]},
                planning.settings.cable_radius_mm,
                planned);
  }
  for (const CellBody& body : planning.bodies) {
    add_capsule(body.name,
                vector_of_three(body.from_mm),
                vector_of_three(body.to_mm),
                body.radius_mm,
                planned);
  }
}

void add_obstacles(const CellPlanning& planning, PlanningCell& planned) {
  for (const CellObstacle& obstacle : planning.obstacles) {
    SolidBody body = {.name = obstacle.name};
    body.mesh = obstacle.file.empty()
                    ? box_mesh(Vector3d::Zero(), vector_of_three(obstacle.size_mm))
                    : read_mesh(obstacle.file);
    const Vector3d turn_rad = vector_of_three(obstacle.rotation_rad);
    RigidTransform pose = {.translation_mm = vector_of_three(obstacle.position_mm)};
    if (turn_rad.norm() > 0.0) {
      pose.rotation = Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()).matrix();
    }
    transform(body.mesh, pose);
    planned.standing.push_back(std::move(body));
  }
}

void add_lights(const SceneSettings& scene, double thickness_mm, PlanningCell& planned) {
  const RigidTransform base = base_from_scene(scene);
  for (SolidBody& body : light_bodies(scene, thickness_mm)) {
    const bool is_carried = body.kind == Kind::kCarried;
    transform(body.mesh, is_carried ? transform_of(planned.flange_from_camera) : base);
    (is_carried ? planned.carried : planned.standing).push_back(std::move(body));
  }
}

/// How far the view's axis goes before it is nearest to the scene's origin: about where the part
/// is.
double target_mm_of(const RigidTransform& scene_from_camera, double working_distance_mm) {
  const double along_mm = -scene_from_camera.rotation.col(2).dot(scene_from_camera.translation_mm);
  return along_mm > 0.0 ? along_mm : working_distance_mm;
}

}  // namespace

Eigen::Isometry3d isometry_of(const RigidTransform& transform) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = transform.rotation;
  pose.translation() = transform.translation_mm;
  return pose;
}

MeasuredPoseSettings measured_flange_from_camera(const SceneSettings& scene, const Cell& cell) {
  const auto pose_in = [](const CalibrationSettings& calibration) {
    return calibration.flange_from_camera;
  };
  if (scene.calibration && pose_in(*scene.calibration)) {
    return *pose_in(*scene.calibration);
  }
  if (!cell.calibration.empty()) {
    if (const auto pose = pose_in(read_calibration_of(cell.calibration))) {
      return *pose;
    }
  }
  throw ConfigError(
      "calibration.flange_from_camera: is missing; the scene or the file that [calibration] of the "
      "cell names has to tell where the camera is on the flange. A camera beside the robot cannot "
      "be planned for");
}

RigidTransform flange_from_camera(const SceneSettings& scene, const Cell& cell) {
  return transform_of(measured_flange_from_camera(scene, cell).pose);
}

RigidTransform base_from_scene(const SceneSettings& scene) {
  if (!scene.cell || !scene.cell->base_from_part) {
    throw ConfigError("cell.base_from_part",
                      "is missing: where the part lies in the frame of the robot's base");
  }
  return transform_of(scene.cell->base_from_part->pose) * inverse(scene_from_part(scene));
}

PlanningCell planning_cell(const Cell& cell, const SceneSettings& scene, const TriangleMesh& part) {
  const PlanningSettings& settings = cell.planning.settings;
  PlanningCell planned = {.arm = arm_with_tool(robot_of(cell), cell.limits)};
  planned.flange_from_camera = isometry_of(flange_from_camera(scene, cell));
  planned.table_mm = settings.table_height_mm;
  planned.margin_mm = settings.margin_mm;
  planned.joint_min_rad = Eigen::Map<const JointVector>(settings.joint_min_rad.data());
  planned.joint_max_rad = Eigen::Map<const JointVector>(settings.joint_max_rad.data());
  planned.min_joint_sine = settings.min_joint_sine;
  for (const CellPosition& position : cell.safe_positions) {
    planned.safe_positions.push_back(
        {.name = position.name,
         .joints_rad = Eigen::Map<const JointVector>(position.joints_rad.data())});
  }
  add_carried(cell.planning, planned);
  add_obstacles(cell.planning, planned);
  SolidBody body = {.name = "part"};
  body.mesh.vertices_mm = part.vertices_mm;
  body.mesh.triangles = part.triangles;
  transform(body.mesh, base_from_scene(scene));
  planned.standing.push_back(std::move(body));
  add_lights(scene, settings.light_thickness_mm, planned);
  return planned;
}

std::vector<ViewRequest> view_requests(const SceneSettings& scene,
                                       const std::vector<Viewpoint>& viewpoints) {
  const RigidTransform base = base_from_scene(scene);
  std::vector<ViewRequest> requests;
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    const RigidTransform in_scene = inverse(camera_from_world(viewpoints[i]));
    requests.push_back({.name = fmt::format("view_{:02d}", i + 1),
                        .base_from_camera = isometry_of(base * in_scene),
                        .target_mm = target_mm_of(in_scene, scene.camera.working_distance_mm)});
  }
  return requests;
}

}  // namespace glint
