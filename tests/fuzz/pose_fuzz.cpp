// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes as a file of poses or of a camera, of the format that the last byte tells: they are
// refused with a text, or give poses whose rotations are rotations.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/error.h"
#include "hardware/poses/camera_file.h"
#include "hardware/poses/pose_file.h"

namespace {

void check_poses(std::string_view text, std::string_view ending) {
  const glint::PoseFile file = glint::parse_pose_file(text, "fuzz", ending);
  if (file.poses.empty()) {
    return;
  }
  for (const glint::RobotPose& pose : glint::robot_poses(file, {}).poses) {
    const Eigen::Matrix3d rotation = pose.base_from_flange.linear();
    const Eigen::Matrix3d left = rotation * rotation.transpose() - Eigen::Matrix3d::Identity();
    GLINT_CHECK(left.cwiseAbs().maxCoeff() < 1e-9, "a rotation");
    GLINT_CHECK(rotation.determinant() > 0.0, "no mirror");
  }
}

void check_camera(std::string_view text, std::string_view ending) {
  const glint::PinholeIntrinsics camera = glint::parse_camera_file(text, "fuzz", ending).intrinsics;
  GLINT_CHECK(camera.focal_px.minCoeff() > 0.0, "focal lengths are positive");
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<std::string_view, 4> kPoses = {".csv", ".json", ".toml", ".yaml"};
  constexpr std::array<std::string_view, 3> kCameras = {".toml", ".yaml", ".xml"};
  if (size == 0) {
    return 0;
  }
  const std::string_view text(reinterpret_cast<const char*>(data), size - 1);
  const std::size_t kind = data[size - 1] % (kPoses.size() + kCameras.size());
  try {
    if (kind < kPoses.size()) {
      check_poses(text, kPoses[kind]);
    } else {
      check_camera(text, kCameras[kind - kPoses.size()]);
    }
  } catch (const glint::ConfigError& error) {
    GLINT_CHECK(error.what()[0] != '\0', "errors have a text");
  }
  return 0;
}
