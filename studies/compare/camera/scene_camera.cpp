// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/camera/scene_camera.h"

#include <vector>

#include "core/config/toml.h"
#include "core/error.h"

namespace glint {

SceneSettings read_calibrated_scene(const std::filesystem::path& file) {
  const ConfigNode root = load_toml(file);
  if (root.find("camera") == nullptr) {
    throw ConfigError(file.string() + ": is no calibration: has no table [camera]");
  }
  std::vector<Problem> errors;
  SceneSettings calibrated = read_scene(root, errors);
  throw_if_any(errors);
  return calibrated;
}

void put_intrinsics(const PinholeIntrinsics& in, SceneSettings& scene) {
  CameraSettings& camera = scene.camera;
  camera.focal_x_px = in.focal_px.x();
  camera.focal_y_px = in.focal_px.y();
  camera.center_x_px = in.center_px.x();
  camera.center_y_px = in.center_px.y();
  camera.k1 = in.radial[0];
  camera.k2 = in.radial[1];
  camera.k3 = in.radial[2];
  camera.p1 = in.tangential[0];
  camera.p2 = in.tangential[1];
}

Viewpoint viewpoint_of_pose(const RigidTransform& camera_from_scene) {
  const RigidTransform pose = inverse(camera_from_scene);
  const auto list = [](const Eigen::Vector3d& v) {
    return std::vector<double>{v.x(), v.y(), v.z()};
  };
  return {.position_mm = list(pose.translation_mm),
          .direction = list(pose.rotation.col(2)),
          .up = list(-pose.rotation.col(1))};
}

}  // namespace glint
