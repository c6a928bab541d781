// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/part_views.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/csv.h"
#include "core/error.h"
#include "core/units.h"
#include "simulator/camera/pinhole_camera.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/definition/study.h"
#include "studies/imaging/built_part.h"
#include "studies/validate/validated_scene.h"

namespace glint::calibrate_cell_detail {
namespace fs = std::filesystem;

namespace {

using Eigen::Vector3d;

constexpr std::size_t kMinViews = 3;
constexpr double kTiltRad = 20.0 * kRadPerDeg;

Vector3d vector(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

std::vector<double> numbers(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

void check(const SceneSettings& scene, const fs::path& file) {
  if (!scene.calibration || !scene.calibration->flange_from_camera) {
    throw ConfigError(
        "--camera: the calibration does not say where the camera is on the flange, so the part's "
        "place in the cell cannot be found from its pictures");
  }
  if (!scene.cell || !scene.cell->base_from_part) {
    throw ConfigError(fmt::format(
        "{}: cell.base_from_part: is missing: about where the part lies in the robot's base, from "
        "which its views are planned",
        file.string()));
  }
  if (!allows_many_viewpoints(scene)) {
    throw ConfigError(
        fmt::format("{}: can have one viewpoint only, the part's place needs several: take a scene "
                    "that lights other than a tunnel shine on",
                    file.string()));
  }
}

std::vector<SeenEdge> every_few(const std::vector<SeenEdge>& seen) {
  const std::size_t step = std::max<std::size_t>(1, (seen.size() + kMaxEdges - 1) / kMaxEdges);
  std::vector<SeenEdge> few;
  for (std::size_t i = step / 2; i < seen.size(); i += step) {
    few.push_back(seen[i]);
  }
  return few;
}

}  // namespace

std::vector<Viewpoint> tilted_views(const Viewpoint& viewpoint, double distance_mm) {
  const RigidTransform scene_from_camera = inverse(camera_from_world(viewpoint));
  const Vector3d target_mm = scene_from_camera * Vector3d(0.0, 0.0, distance_mm);
  std::vector<Viewpoint> views;
  for (int i = 0; i < 4; ++i) {
    const double azimuth_rad = (i + 0.5) * 0.5 * kPi;
    const Vector3d axis =
        scene_from_camera.rotation * Vector3d(std::cos(azimuth_rad), std::sin(azimuth_rad), 0.0);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(kTiltRad, axis).matrix();
    views.push_back(
        {.position_mm = numbers(target_mm + turn * (vector(viewpoint.position_mm) - target_mm)),
         .direction = numbers(turn * scene_from_camera.rotation.col(2)),
         .up = numbers(turn * -scene_from_camera.rotation.col(1))});
  }
  return views;
}

SceneSettings part_scene(const fs::path& file, const fs::path& calibration) {
  SceneSettings scene = load_study(file, {}).scene;
  take_calibration(calibration / "calibration.toml", scene);
  check(scene, file);
  std::vector<Viewpoint> views = viewpoints_of(scene, build_part_with_bvh(scene.part).part);
  if (views.size() < kMinViews) {
    const double far_mm = scene.camera.working_distance_mm;
    const std::vector<Viewpoint> around = tilted_views(views.front(), far_mm);
    views.insert(views.end(), around.begin(), around.end());
  }
  for (Viewpoint& viewpoint : views) {
    viewpoint.base_from_flange.reset();
  }
  scene.viewpoints = views;
  scene.viewpoint_set.source = ViewpointSource::kListed;
  scene.reference.reset();
  return scene;
}

Viewpoint viewpoint_at(const SceneSettings& scene, const Eigen::Isometry3d& base_from_flange) {
  const RigidTransform flange = {.rotation = base_from_flange.linear(),
                                 .translation_mm = base_from_flange.translation()};
  return viewpoint_of_pose(inverse(scene_from_camera(scene, pose_settings(flange))));
}

std::vector<SeenEdge> seen_edges(const SceneSettings& scene,
                                 const Viewpoint& viewpoint,
                                 std::span<const SpaceEdge> edges,
                                 const PlaceDoubt& doubt) {
  const PinholeCamera camera(intrinsics_of(scene));
  const RigidTransform part_from_camera =
      inverse(pose_from_angles(vector(scene.part.position_mm), vector(scene.part.rotation_rad))) *
      inverse(camera_from_world(viewpoint));
  std::vector<SeenEdge> seen;
  for (const SpaceEdge& edge : edges) {
    const Vector3d part_mm = part_from_camera * edge.in_camera_mm;
    const double px_per_mm = camera.intrinsics().focal_px.x() / edge.in_camera_mm.z();
    const auto pixel = camera.project(edge.in_camera_mm);
    if (pixel && edge.free_px > px_per_mm * (doubt.mm + doubt.rad * part_mm.norm())) {
      seen.push_back({.part_mm = part_mm,
                      .pixel_px = *pixel + edge.offset_px * edge.normal,
                      .normal = edge.normal,
                      .px_per_mm = px_per_mm});
    }
  }
  return every_few(seen);
}

std::string edge_header() {
  return csv_row_of("picture", "x_mm", "y_mm", "z_mm", "u_px", "v_px", "normal_u", "normal_v");
}

std::string edge_rows(const std::string& picture, std::span<const SeenEdge> edges) {
  std::string text;
  for (const SeenEdge& edge : edges) {
    text += csv_row_of(picture,
                       edge.part_mm.x(),
                       edge.part_mm.y(),
                       edge.part_mm.z(),
                       edge.pixel_px.x(),
                       edge.pixel_px.y(),
                       edge.normal.x(),
                       edge.normal.y());
  }
  return text;
}

}  // namespace glint::calibrate_cell_detail
