// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibration_trial/trial_errors.h"

#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/config/pose_keys.h"
#include "core/error.h"
#include "core/units.h"
#include "simulator/camera/pinhole_camera.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

RigidTransform pose_from(const Json& json) {
  return transform_of(
      {.translation_mm = json.at("translation_mm").get<std::vector<double>>(),
       .rotation_vector_rad = json.at("rotation_vector_rad").get<std::vector<double>>()});
}

double angle_between_rad(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.transpose() * b)).angle();
}

/// A mean of squares.
struct Squares {
  double sum = 0.0;
  int count = 0;

  void add(double value) {
    sum += value;
    ++count;
  }

  double root() const { return count > 0 ? std::sqrt(sum / count) : 0.0; }
};

/// Where the ray through a pixel meets the board's plane, in the board's frame.
std::optional<Vector3d> point_on_board_mm(const PinholeCamera& camera,
                                          const RigidTransform& camera_from_board,
                                          const Vector2d& pixel_px) {
  const auto ray = camera.ray_through(pixel_px);
  if (!ray) {
    return std::nullopt;
  }
  const RigidTransform back = inverse(camera_from_board);
  const Vector3d direction = back.rotation * *ray;
  if (!(std::abs(direction.z()) > 1e-6)) {
    return std::nullopt;
  }
  return back.translation_mm - back.translation_mm.z() / direction.z() * direction;
}

OverlapError overlap_error(const CameraOnRobot& truth,
                           const CameraOnRobot& estimate,
                           const std::vector<RigidTransform>& poses) {
  constexpr int kGrid = 15;
  const PinholeCamera camera(truth.intrinsics);
  const PinholeCamera estimated(estimate.intrinsics);
  const Vector2d size_px(truth.intrinsics.width_px, truth.intrinsics.height_px);
  Squares all;
  Squares center;
  Squares edge;
  for (const RigidTransform& pose : poses) {
    const RigidTransform view = camera_from_board(truth, pose);
    const RigidTransform estimated_view = camera_from_board(estimate, pose);
    for (int i = 0; i < kGrid * kGrid; ++i) {
      const int row = i / kGrid;
      const Vector2d pixel =
          size_px.cwiseProduct(Vector2d(i % kGrid + 0.5, row + 0.5)) / double{kGrid};
      const auto point = point_on_board_mm(camera, view, pixel);
      const auto seen = point ? estimated.project(estimated_view * *point) : std::nullopt;
      if (!seen) {
        continue;
      }
      const double square = (*seen - pixel).squaredNorm();
      const double radius = (pixel - 0.5 * size_px).norm() / size_px.x();
      all.add(square);
      if (radius < 1.0 / 6.0) {
        center.add(square);
      } else if (radius > 0.4) {
        edge.add(square);
      }
    }
  }
  return {.rms_px = all.root(), .center_px = center.root(), .edge_px = edge.root()};
}

}  // namespace

CameraOnRobot estimate_of(const Json& calibration) {
  const Json& in = calibration.at("intrinsics");
  const auto two = [&](const char* key) {
    return Vector2d(in.at(key).at(0).get<double>(), in.at(key).at(1).get<double>());
  };
  const bool is_in_hand = calibration.at("setup") == "eye_in_hand";
  return {.intrinsics = {.width_px = in.at("width_px").get<int>(),
                         .height_px = in.at("height_px").get<int>(),
                         .focal_px = two("focal_px"),
                         .center_px = two("center_px"),
                         .radial = in.at("radial").get<std::array<double, 3>>(),
                         .tangential = in.at("tangential").get<std::array<double, 2>>()},
          .setup = is_in_hand ? CalibrationSetup::kEyeInHand : CalibrationSetup::kEyeToHand,
          .hand_eye = pose_from(calibration.at("hand_eye")),
          .board = pose_from(calibration.at("board").at("pose"))};
}

TrialErrors trial_errors(const CameraOnRobot& truth,
                         const CameraOnRobot& estimate,
                         const std::vector<RigidTransform>& poses) {
  GLINT_CHECK(!poses.empty(), "an overlap needs poses");
  const double turn = angle_between_rad(truth.board.rotation, estimate.board.rotation);
  return {
      .rotation_rad = angle_between_rad(truth.hand_eye.rotation, estimate.hand_eye.rotation),
      .translation_mm = (truth.hand_eye.translation_mm - estimate.hand_eye.translation_mm).norm(),
      .is_board_upright = turn < 0.25 * kPi,
      .overlap = overlap_error(truth, estimate, poses)};
}

// Source of the goals: a joint adjustment of simulated data with these errors reaches them in the
// median; docs/theory/calibration.md.
std::vector<TrialGoal> trial_goals(const TrialErrors& errors) {
  const OverlapError& overlap = errors.overlap;
  return {{"rotation of the hand-eye", "deg", errors.rotation_rad * kDegPerRad, 0.010},
          {"position of the hand-eye", "mm", errors.translation_mm, 0.030},
          {"overlap at new poses", "px", overlap.rms_px, 0.41},
          {"growth of the overlap from centre to edge",
           "px",
           overlap.edge_px - overlap.center_px,
           0.05}};
}

}  // namespace glint
