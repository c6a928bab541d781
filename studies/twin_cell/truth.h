// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a simulated cell is in truth, and what its user does not know: a scene, and in its table
// [truth] where the camera sits on the flange, where the part lies and how well a person puts it
// back there, and how far the arm's joints are from what they tell.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/pose.h"
#include "studies/definition/scene.h"

namespace glint {

/// Keys of [truth]. Rotations are vectors: axis times angle.
struct TruthSettings {
  bool is_eye_to_hand = false;  ///< camera in the base, scene on the flange; else the other way
  std::vector<double> camera_position_mm = {0.0, 0.0, 0.0};  ///< of the camera on the flange
  std::vector<double> camera_rotation_rad = {0.0, 0.0, 0.0};
  std::vector<double> scene_position_mm = {0.0, 0.0, 0.0};  ///< of the scene's origin in the base
  std::vector<double> scene_rotation_rad = {0.0, 0.0, 0.0};
  /// How far the scene lies elsewhere each time that it is put down: standard deviations along and
  /// about its own axes, >= 0.
  std::vector<double> placement_mm = {0.0, 0.0, 0.0};
  std::vector<double> placement_rad = {0.0, 0.0, 0.0};
  double exposure_s = 0.01;        ///< > 0; at which the sensor.exposure of the truth holds
  double position_noise_mm = 0.0;  ///< >= 0; of the flange at each pose, per axis
  double rotation_noise_rad = 0.0;
  double joint_noise_rad = 0.0;  ///< >= 0; of each joint at each pose
  int seed = 1;                  ///< >= 0
};

void visit_keys(KeyVisitor& keys, TruthSettings& settings);

struct Truth {
  SceneSettings scene;
  TruthSettings settings;

  /// The camera in the frame that carries it: the flange, or the base.
  RigidTransform carrier_from_camera() const;

  /// The scene in the frame that it lies in: the base, or the flange.
  /// @param placement  counted from 1: how many times it has been put down
  RigidTransform carrier_from_scene(int placement = 1) const;

  /// @param base_from_flange  as the robot tells it
  /// @param flange_error      base_from_flange * flange_error is where it is
  RigidTransform scene_from_camera(const RigidTransform& base_from_flange,
                                   const RigidTransform& flange_error,
                                   int placement = 1) const;

  /// The flange that gives that scene_from_camera.
  RigidTransform base_from_flange(const RigidTransform& scene_from_camera) const;
};

/// @throws ConfigError with every problem, IoError
Truth read_truth(const std::filesystem::path& file);

RigidTransform transform_of(const Eigen::Isometry3d& pose);

/// The rotation about a vector's direction by its length.
RigidTransform pose_of(const std::vector<double>& position_mm,
                       const std::vector<double>& rotation_rad);

}  // namespace glint
