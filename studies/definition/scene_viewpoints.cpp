// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene_viewpoints.h"

#include <algorithm>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "core/rng.h"
#include "simulator/geometry/surface/surface_sampling.h"

namespace glint {
namespace {

constexpr const char* kFlange = "base_from_flange";

/// Nine numbers, or the flange's pose; both when the keys are listed.
void visit_viewpoint(KeyVisitor& keys, Viewpoint& viewpoint) {
  if (!viewpoint.base_from_flange) {
    visit_keys(keys, viewpoint);
  }
  keys.optional_table(kFlange, viewpoint.base_from_flange, "instead of the nine numbers");
  for (const char* key : {"position_mm", "direction", "up"}) {
    keys.require(!viewpoint.base_from_flange || !keys.is_given(key),
                 key,
                 "cannot be given beside base_from_flange, which says where the camera is");
  }
}

Problem of_flange(const std::string& text) {
  return {.kind = Problem::Kind::kRelation, .key = kFlange, .text = text};
}

/// The two tables that turn a pose of the flange into one of the camera.
struct FlangeChain {
  RigidTransform camera;  ///< flange_from_camera, or base_from_camera
  RigidTransform part;    ///< base_from_part, or flange_from_part
};

/// @throws ConfigError
FlangeChain chain_of(const SceneSettings& scene) {
  const CalibrationSettings calibration = scene.calibration.value_or(CalibrationSettings{});
  const CellSettings cell = scene.cell.value_or(CellSettings{});
  if (calibration.flange_from_camera) {
    if (!cell.base_from_part) {
      throw ConfigError(of_flange(
          "needs [cell.base_from_part]: the camera is on the flange, and where the part lies in "
          "the frame of the robot's base is not given"));
    }
    return {.camera = transform_of(calibration.flange_from_camera->pose),
            .part = transform_of(cell.base_from_part->pose)};
  }
  if (calibration.base_from_camera) {
    if (!cell.flange_from_part) {
      throw ConfigError(of_flange(
          "needs [cell.flange_from_part]: the camera stands beside the robot, and where the robot "
          "holds the part is not given"));
    }
    return {.camera = transform_of(calibration.base_from_camera->pose),
            .part = transform_of(cell.flange_from_part->pose)};
  }
  throw ConfigError(of_flange(
      "needs [calibration.flange_from_camera] or [calibration.base_from_camera], as in the "
      "calibration.toml of glint calibrate"));
}

void place_by_flange(const SceneSettings& scene, Viewpoint& viewpoint) {
  const RigidTransform camera = scene_from_camera(scene, *viewpoint.base_from_flange);
  const auto numbers = [](const Eigen::Vector3d& v) { return std::vector{v.x(), v.y(), v.z()}; };
  viewpoint.position_mm = numbers(camera.translation_mm);
  viewpoint.direction = numbers(camera.rotation.col(2));
  viewpoint.up = numbers(-camera.rotation.col(1));
}

void read_viewpoint(const ConfigNode& item,
                    std::size_t i,
                    const SceneSettings& scene,
                    Viewpoint& viewpoint,
                    std::vector<Problem>& errors) {
  const std::string path = fmt::format("viewpoint.{}", i);
  KeyReader reader(&item, path, errors);
  visit_viewpoint(reader, viewpoint);
  reader.report_unknown();
  if (!viewpoint.base_from_flange) {
    return;
  }
  try {
    place_by_flange(scene, viewpoint);
  } catch (const ConfigError& error) {
    for (Problem problem : error.problems()) {
      problem.place = item.find(kFlange)->place;
      problem.key = joined_path(path, problem.key);
      errors.push_back(std::move(problem));
    }
  }
}

/// Of some random points the one farthest from all others so far.
AreaSampler::Sample far_point(const TriangleMesh& mesh,
                              const AreaSampler& sampler,
                              std::span<const Eigen::Vector3d> others_mm,
                              Rng& rng) {
  constexpr int kCandidates = 32;
  AreaSampler::Sample best;
  double max_mm2 = -1.0;
  for (int k = 0; k < kCandidates; ++k) {
    const AreaSampler::Sample candidate = sampler.draw(mesh, rng);
    double nearest_mm2 = std::numeric_limits<double>::max();
    for (const Eigen::Vector3d& other_mm : others_mm) {
      nearest_mm2 = std::min(nearest_mm2, (candidate.point_mm - other_mm).squaredNorm());
    }
    if (nearest_mm2 > max_mm2) {
      max_mm2 = nearest_mm2;
      best = candidate;
    }
  }
  return best;
}

/// Points spread over the part's surface, seen from outside.
std::vector<Viewpoint> along_surface(const SceneSettings& scene, const Part& part) {
  const AreaSampler sampler(part.mesh);
  Rng rng(0, Stream::kViewpoints, 0);
  std::vector<Eigen::Vector3d> points_mm;
  std::vector<Eigen::Vector3d> normals;
  for (int i = 0; i < scene.viewpoint_set.count; ++i) {
    const AreaSampler::Sample at = far_point(part.mesh, sampler, points_mm, rng);
    const SurfacePoint smooth = smooth_point(part, at.triangle, at.point_mm);
    points_mm.push_back(smooth.point_mm);
    normals.push_back(smooth.normal);
  }
  return surface_viewpoints(
      points_mm, normals, scene.camera.working_distance_mm, scene.viewpoint_set);
}

}  // namespace

void read_listed_viewpoints(const ConfigNode& root,
                            const std::string& name,
                            SceneSettings& scene,
                            std::vector<Problem>& errors) {
  scene.viewpoints = {default_viewpoint(scene.camera)};
  const ConfigNode* list = root.find(name);
  if (list == nullptr) {
    return;
  }
  if (!list->is_array() || list->items.empty()) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = list->place,
                      .key = "viewpoint",
                      .text = "must be one or more [[viewpoint]]; position_mm, direction, up, or "
                              "base_from_flange"});
    return;
  }
  scene.viewpoints.assign(list->items.size(), default_viewpoint(scene.camera));
  for (std::size_t i = 0; i < list->items.size(); ++i) {
    read_viewpoint(list->items[i], i, scene, scene.viewpoints[i], errors);
  }
}

ConfigNode write_listed_viewpoints(const SceneSettings& scene) {
  ConfigNode list = ConfigNode::array();
  for (Viewpoint viewpoint : scene.viewpoints) {
    ConfigNode table = ConfigNode::table();
    KeyWriter writer(table);
    visit_viewpoint(writer, viewpoint);
    list.items.push_back(std::move(table));
  }
  return list;
}

std::vector<KeyRow> listed_viewpoint_keys() {
  std::vector<KeyRow> rows;
  KeyLister lister("viewpoint.0", rows);
  Viewpoint viewpoint;
  visit_viewpoint(lister, viewpoint);
  return rows;
}

RigidTransform scene_from_camera(const SceneSettings& scene, const PoseSettings& base_from_flange) {
  const FlangeChain chain = chain_of(scene);
  const RigidTransform base_from_flange_pose = transform_of(base_from_flange);
  const bool is_in_hand = scene.calibration->flange_from_camera.has_value();
  const RigidTransform part_from_camera =
      inverse(chain.part) * (is_in_hand ? base_from_flange_pose : inverse(base_from_flange_pose)) *
      chain.camera;
  const auto vector = [](const std::vector<double>& v) {
    return Eigen::Vector3d(v[0], v[1], v[2]);
  };
  return pose_from_angles(vector(scene.part.position_mm), vector(scene.part.rotation_rad)) *
         part_from_camera;
}

std::vector<Viewpoint> viewpoints_of(const SceneSettings& scene, const Part& part) {
  switch (scene.viewpoint_set.source) {
    case ViewpointSource::kListed:
      return scene.viewpoints;
    case ViewpointSource::kSurface:
      return along_surface(scene, part);
    case ViewpointSource::kFile:
    case ViewpointSource::kSphere:
      break;
  }
  return make_viewpoints(scene.viewpoint_set, scene.camera.working_distance_mm);
}

}  // namespace glint
