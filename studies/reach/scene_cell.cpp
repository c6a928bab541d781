// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/reach/scene_cell.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/config/toml.h"
#include "core/pose.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "studies/definition/scene_lights.h"
#include "studies/reach/light_bodies.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Kind = SolidBody::Kind;

constexpr int kFlange = 6;

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
  return pose_from_angles(vector_of(scene.part.position_mm), vector_of(scene.part.rotation_rad));
}

/// Puts a body where its frame is.
void add_body(SolidBody body,
              bool is_carried,
              const RigidTransform& carrier_from_body,
              PlanningCell& planned) {
  body.kind = is_carried ? Kind::kCarried : Kind::kStanding;
  body.link = is_carried ? kFlange : 0;
  transform(body.mesh, carrier_from_body);
  (is_carried ? planned.carried : planned.standing).push_back(std::move(body));
}

void add_camera(const PlanningSettings& settings, const CellChain& chain, PlanningCell& planned) {
  if (settings.camera_size_mm.empty()) {
    return;
  }
  const Vector3d size_mm = vector_of(settings.camera_size_mm);
  SolidBody body = {.name = "camera"};
  body.mesh = box_mesh(Vector3d(0.0, 0.0, settings.camera_front_mm - 0.5 * size_mm.z()), size_mm);
  add_body(std::move(body), chain.is_in_hand, chain.carrier_from_camera, planned);
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

void add_carried(const CellPlanning& planning, const CellChain& chain, PlanningCell& planned) {
  add_camera(planning.settings, chain, planned);
  const std::vector<double>& cable = planning.settings.cable_mm;
  for (std::size_t i = 3; i + 2 < cable.size(); i += 3) {
    add_capsule("cable",
                {cable[i - 3], cable[i - 2], cable[i - 1]},
                {cable[i], cable[i + 1], cable[i + 2]},
                planning.settings.cable_radius_mm,
                planned);
  }
  for (const CellBody& body : planning.bodies) {
    add_capsule(body.name, vector_of(body.from_mm), vector_of(body.to_mm), body.radius_mm, planned);
  }
}

void add_obstacles(const CellPlanning& planning, PlanningCell& planned) {
  for (const CellObstacle& obstacle : planning.obstacles) {
    SolidBody body = {.name = obstacle.name};
    body.mesh = obstacle.file.empty() ? box_mesh(Vector3d::Zero(), vector_of(obstacle.size_mm))
                                      : read_mesh(obstacle.file);
    const Vector3d turn_rad = vector_of(obstacle.rotation_rad);
    RigidTransform pose = {.translation_mm = vector_of(obstacle.position_mm)};
    if (turn_rad.norm() > 0.0) {
      pose.rotation = Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()).matrix();
    }
    transform(body.mesh, pose);
    planned.standing.push_back(std::move(body));
  }
}

void add_lights(const SceneSettings& scene,
                const CellChain& chain,
                double thickness_mm,
                PlanningCell& planned) {
  if (!chain.is_in_hand) {
    check_lights_go_along(scene);
  }
  for (SolidBody& body : light_bodies(scene, thickness_mm)) {
    const bool is_at_camera = body.kind == Kind::kCarried;
    add_body(std::move(body),
             is_at_camera == chain.is_in_hand,
             is_at_camera ? chain.carrier_from_camera : chain.carrier_from_scene,
             planned);
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

namespace {

/// The calibration that tells where the camera is; none: neither file does.
/// @param own  of a scene; wins
std::optional<CalibrationSettings> calibration_of(const std::optional<CalibrationSettings>& own,
                                                  const Cell& cell) {
  const auto tells = [](const std::optional<CalibrationSettings>& calibration) {
    return calibration && (calibration->flange_from_camera || calibration->base_from_camera);
  };
  std::optional<CalibrationSettings> calibration = own;
  if (!tells(calibration) && !cell.calibration.empty()) {
    calibration = read_calibration_of(cell.calibration);
  }
  return tells(calibration) ? calibration : std::nullopt;
}

/// Without the part.
CellChain camera_chain(const CalibrationSettings& calibration) {
  CellChain chain = {.is_in_hand = calibration.flange_from_camera.has_value()};
  chain.camera = chain.is_in_hand ? *calibration.flange_from_camera : *calibration.base_from_camera;
  chain.carrier_from_camera = transform_of(chain.camera.pose);
  return chain;
}

/// Arm, table, limits and safe positions: without bodies.
PlanningCell bare_cell(const Cell& cell) {
  const PlanningSettings& settings = cell.planning.settings;
  PlanningCell planned = {.arm = arm_with_tool(robot_of(cell), cell.limits)};
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
  return planned;
}

/// Of a scene whose own frame is nowhere in the cell.
void add_lights_at_camera(const SceneSettings& scene,
                          const CellChain& chain,
                          double thickness_mm,
                          PlanningCell& planned) {
  for (SolidBody& body : light_bodies(scene, thickness_mm)) {
    if (body.kind == Kind::kCarried) {  // by the camera
      add_body(std::move(body), chain.is_in_hand, chain.carrier_from_camera, planned);
    }
  }
}

/// With the camera, what the flange carries beside it, and what stands.
void add_bodies(const Cell& cell, const CellChain& chain, PlanningCell& planned) {
  if (chain.is_in_hand) {
    planned.flange_from_camera = isometry_of(chain.carrier_from_camera);
  }
  add_carried(cell.planning, chain, planned);
  add_obstacles(cell.planning, planned);
}

}  // namespace

RigidTransform CellChain::scene_from_camera(const RigidTransform& base_from_flange) const {
  const RigidTransform scene_from_carrier = inverse(carrier_from_scene);
  return is_in_hand ? scene_from_carrier * base_from_flange * carrier_from_camera
                    : scene_from_carrier * inverse(base_from_flange) * carrier_from_camera;
}

CellChain cell_chain(const SceneSettings& scene, const Cell& cell) {
  const auto calibration = calibration_of(scene.calibration, cell);
  if (!calibration) {
    throw ConfigError(
        "calibration.flange_from_camera: is missing; the scene, or the file that [calibration] of "
        "the cell names, has to say where the camera is on the flange; base_from_camera says it "
        "of a camera beside the robot");
  }
  CellChain chain = camera_chain(*calibration);
  if (chain.is_in_hand && !(scene.cell && scene.cell->base_from_part)) {
    throw ConfigError("cell.base_from_part",
                      "is missing: where the part lies in the frame of the robot's base");
  }
  if (!chain.is_in_hand && !(scene.cell && scene.cell->flange_from_part)) {
    throw ConfigError("cell.flange_from_part",
                      "is missing: the camera stands beside the robot, so the flange has to hold "
                      "the part up to it");
  }
  chain.part = chain.is_in_hand ? *scene.cell->base_from_part : *scene.cell->flange_from_part;
  chain.carrier_from_scene = transform_of(chain.part.pose) * inverse(scene_from_part(scene));
  return chain;
}

bool has_cell_chain(const SceneSettings& scene, const Cell& cell) {
  const auto calibration = calibration_of(scene.calibration, cell);
  return calibration && scene.cell &&
         (calibration->flange_from_camera ? scene.cell->base_from_part.has_value()
                                          : scene.cell->flange_from_part.has_value());
}

PlanningCell planning_cell(const Cell& cell, const SceneSettings& scene, const TriangleMesh& part) {
  const CellChain chain = cell_chain(scene, cell);
  PlanningCell planned = bare_cell(cell);
  add_bodies(cell, chain, planned);
  SolidBody body = {.name = "part"};
  body.mesh.vertices_mm = part.vertices_mm;
  body.mesh.triangles = part.triangles;
  add_body(std::move(body), !chain.is_in_hand, chain.carrier_from_scene, planned);
  add_lights(scene, chain, cell.planning.settings.light_thickness_mm, planned);
  return planned;
}

PlanningCell planning_cell(const Cell& cell, const SceneSettings* scene) {
  const auto calibration =
      calibration_of(scene != nullptr ? scene->calibration : std::nullopt, cell);
  if (!calibration && !cell.planning.settings.camera_size_mm.empty()) {
    throw ConfigError(fmt::format(
        "{}: planning.camera_size_mm: the camera's place on the flange is not known, so its room "
        "cannot be kept free; set file of [calibration] to a file with "
        "[calibration.flange_from_camera] (values from the drawing are good enough)",
        cell.file.string()));
  }
  PlanningCell planned = bare_cell(cell);
  add_bodies(cell, calibration ? camera_chain(*calibration) : CellChain(), planned);
  if (scene != nullptr && calibration) {
    add_lights_at_camera(
        *scene, camera_chain(*calibration), cell.planning.settings.light_thickness_mm, planned);
  }
  return planned;
}

std::vector<ViewRequest> view_requests(const SceneSettings& scene,
                                       const Cell& cell,
                                       const std::vector<Viewpoint>& viewpoints) {
  const CellChain chain = cell_chain(scene, cell);
  std::vector<ViewRequest> requests;
  for (std::size_t i = 0; i < viewpoints.size(); ++i) {
    const RigidTransform in_scene = inverse(camera_from_world(viewpoints[i]));
    const Eigen::Isometry3d seen = isometry_of(chain.carrier_from_scene * in_scene);
    ViewRequest request = {.name = fmt::format("view_{:02d}", i + 1),
                           .base_from_camera = seen,
                           .target_mm = target_mm_of(in_scene, scene.camera.working_distance_mm)};
    if (!chain.is_in_hand) {
      request.base_from_camera = isometry_of(chain.carrier_from_camera);
      request.flange_from_camera = seen;
    }
    requests.push_back(std::move(request));
  }
  return requests;
}

}  // namespace glint
