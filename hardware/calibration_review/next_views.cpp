// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/next_views.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/units.h"
#include "hardware/calibration/camera_bundle.h"
#include "hardware/calibration/joint_fit.h"
#include "hardware/calibration/rotation.h"
#include "hardware/calibration/variance_components.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<double, 3> kTilts = {0.0, 15.0 * kRadPerDeg, 30.0 * kRadPerDeg};
constexpr int kSides = 8;
constexpr std::array<double, 4> kRolls = {
    0.0, 45.0 * kRadPerDeg, -45.0 * kRadPerDeg, 90.0 * kRadPerDeg};
constexpr std::array<double, 3> kDistances = {1.0, 0.85, 1.15};
constexpr double kMargin = 0.02;  // of the picture's size, free beside the board

/// What all candidates have in common.
struct Scene {
  const Bundle& bundle;
  const std::vector<Vector3d>& board_mm;
  Vector2d size_px;
  Vector3d middle_mm = Vector3d::Zero();
  double distance_mm = 0.0;  ///< median
  Eigen::Matrix3d facing = Eigen::Matrix3d::Identity();
};

Scene scene_of(const Bundle& bundle, const std::vector<Vector3d>& board_mm, const Vector2d& size) {
  Scene scene{.bundle = bundle, .board_mm = board_mm, .size_px = size};
  for (const Vector3d& point : board_mm) {
    scene.middle_mm += point / static_cast<double>(board_mm.size());
  }
  std::vector<Isometry3d> poses;
  std::vector<double> distances;
  for (const BundleView& view : bundle.views) {
    poses.push_back(pose_of(bundle, view));
    distances.push_back((poses.back() * scene.middle_mm).norm());
  }
  std::ranges::sort(distances);
  scene.distance_mm = distances[distances.size() / 2];
  // The mean of the rolls, without tilt; the board's axis points away from or to the camera.
  const Eigen::Matrix3d mean = mean_pose(poses).linear();
  const double side = mean(2, 2) < 0.0 ? -1.0 : 1.0;
  scene.facing = rotation_of(std::atan2(mean(1, 0), mean(0, 0)) * Vector3d::UnitZ()) *
                 Vector3d(1.0, side, side).asDiagonal();
  return scene;
}

/// The corners as they would be seen; empty when one is too near to the border.
std::optional<BoardCorners> seen_corners(const Scene& scene, const Isometry3d& camera_from_board) {
  BoardCorners corners{.board_mm = scene.board_mm};
  const Vector2d margin = kMargin * scene.size_px;
  for (const Vector3d& point : scene.board_mm) {
    const auto pixel = project_by_lens(scene.bundle.lens, camera_from_board * point, nullptr);
    if (!pixel.has_value() || (*pixel - margin).minCoeff() < 0.0 ||
        (scene.size_px - margin - *pixel).minCoeff() < 0.0) {
      return std::nullopt;
    }
    corners.picture_px.push_back(*pixel);
  }
  return corners;
}

struct Candidate {
  NextView view;
  MatrixXd information;
};

void add_candidate(const Scene& scene, NextView view, std::vector<Candidate>& candidates) {
  const double turn = view.near_side_rad + 0.5 * kPi;
  const LensVector& lens = scene.bundle.lens;
  const Vector2d slope = (view.middle_px - lens.segment<2>(2)).cwiseQuotient(lens.head<2>());
  const Vector3d middle = view.distance_mm * slope.homogeneous().normalized();
  view.camera_from_board.linear() =
      rotation_of(view.tilt_rad * Vector3d(std::cos(turn), std::sin(turn), 0.0)) *
      rotation_of(view.roll_rad * Vector3d::UnitZ()) * scene.facing;
  view.camera_from_board.translation() = middle - view.camera_from_board.linear() * scene.middle_mm;
  const auto corners = seen_corners(scene, view.camera_from_board);
  if (!corners.has_value()) {
    return;
  }
  Bundle alone = without_views(scene.bundle);
  alone.lens_prior.reset();
  if (scene.bundle.are_poses_free) {
    view.base_from_flange =
        flange_that_sees(scene.bundle.mounting, scene.bundle.poses, view.camera_from_board);
    alone.views = {joint_view(*corners, *view.base_from_flange)};
  } else {
    alone.views = {free_view(*corners, view.camera_from_board)};
  }
  candidates.push_back(
      {.view = view,
       .information = shared_information(alone, compress(alone), alone.noise).hessian});
}

std::vector<Candidate> candidates_of(const Scene& scene) {
  std::vector<Candidate> candidates;
  for (const double tilt : kTilts) {
    for (int side = 0; side < (tilt > 0.0 ? kSides : 1); ++side) {
      for (const double roll : kRolls) {
        for (int place = 0; place < 9; ++place) {
          const int row = place / 3;
          const Vector2d at(0.5 + 0.2 * (place % 3 - 1), 0.5 + 0.2 * (row - 1));
          for (const double distance : kDistances) {
            add_candidate(scene,
                          {.tilt_rad = tilt,
                           .near_side_rad = 2.0 * kPi * side / kSides,
                           .roll_rad = roll,
                           .middle_px = scene.size_px.cwiseProduct(at),
                           .distance_mm = distance * scene.distance_mm},
                          candidates);
          }
        }
      }
    }
  }
  return candidates;
}

/// Points of the board's plane on a grid of pixels. @param pose  camera from board
BoardCorners plane_points(const Scene& scene, const Isometry3d& pose) {
  BoardCorners corners;
  for (int i = 0; i < 49; ++i) {
    const int row = i / 7;
    const Vector2d pixel = scene.size_px.cwiseProduct(Vector2d(i % 7 + 0.5, row + 0.5)) / 7.0;
    const Vector2d slope =
        (pixel - scene.bundle.lens.segment<2>(2)).cwiseQuotient(scene.bundle.lens.head<2>());
    const Vector3d origin = pose.inverse().translation();
    const Vector3d ray = pose.linear().transpose() * slope.homogeneous();
    const Vector3d point = origin - origin.z() / ray.z() * ray;
    if (!point.allFinite() || !((pose * point).z() > 0.0)) {
      continue;
    }
    corners.board_mm.push_back(point);
    corners.picture_px.push_back(pixel);
  }
  return corners;
}

/// G with mean square error of computed points = trace(covariance G): points of the board's plane
/// on a grid of pixels in every picture.
MatrixXd error_metric(const Scene& scene) {
  const Bundle& bundle = scene.bundle;
  const Eigen::Index size = num_shared(bundle);
  MatrixXd sum = MatrixXd::Zero(size, size);
  double count = 0.0;
  for (const BundleView& view : bundle.views) {
    const Isometry3d pose = pose_of(bundle, view);
    BundleView seen{.base_from_flange = pose.inverse()};
    if (bundle.are_poses_free) {
      seen.base_from_flange = view.base_from_flange;
    }
    seen.corners = plane_points(scene, pose);
    seen.weights = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(seen.corners.board_mm.size()));
    const auto system = weighted_system(bundle, seen);
    if (system.has_value()) {
      sum += system->by_shared.transpose() * system->by_shared;
      count += static_cast<double>(seen.corners.board_mm.size());
    }
  }
  return sum / std::max(1.0, count);
}

double point_error_px(const MatrixXd& information, const MatrixXd& metric) {
  return std::sqrt(std::max(0.0, (inverse_information(information) * metric).trace()));
}

const char* side_name(double direction_rad) {
  constexpr std::array<const char*, kSides> kNames = {
      "right", "lower right", "lower", "lower left", "left", "upper left", "upper", "upper right"};
  const auto at = std::lround(direction_rad * kSides / (2.0 * kPi));
  return kNames[static_cast<std::size_t>(((at % kSides) + kSides) % kSides)];
}

}  // namespace

ViewAdvice next_views(const Bundle& solved,
                      const std::vector<Vector3d>& board_mm,
                      int width_px,
                      int height_px,
                      int count) {
  if (solved.views.empty() || board_mm.empty() || num_shared(solved) == 0) {
    return {};
  }
  const Scene scene = scene_of(solved, board_mm, Vector2d(width_px, height_px));
  const MatrixXd metric = error_metric(scene);
  MatrixXd known = shared_information(solved, compress(solved), solved.noise).hessian;
  ViewAdvice advice{.point_error_px = point_error_px(known, metric)};
  const std::vector<Candidate> candidates = candidates_of(scene);
  for (int i = 0; i < count && !candidates.empty(); ++i) {
    std::vector<double> errors;
    for (const Candidate& candidate : candidates) {
      errors.push_back(point_error_px(known + candidate.information, metric));
    }
    const auto best = std::ranges::min_element(errors) - errors.begin();
    const Candidate& taken = candidates[static_cast<std::size_t>(best)];
    known += taken.information;
    advice.views.push_back(taken.view);
    advice.views.back().point_error_px = errors[static_cast<std::size_t>(best)];
  }
  return advice;
}

std::string text_of(const NextView& view, int width_px, int height_px) {
  std::string text = view.tilt_rad > 0.0
                         ? fmt::format("the board tilted by {:.0f} degrees, its {} side nearest",
                                       view.tilt_rad * kDegPerRad,
                                       side_name(view.near_side_rad))
                         : std::string("the board seen squarely");
  if (view.roll_rad != 0.0) {
    text += fmt::format(", turned by {:.0f} degrees in the picture", view.roll_rad * kDegPerRad);
  }
  return text + fmt::format(
                    ", its middle at {:.0f} % of the width and {:.0f} % of the height, {:.4g} "
                    "mm away",
                    100.0 * view.middle_px.x() / width_px,
                    100.0 * view.middle_px.y() / height_px,
                    view.distance_mm);
}

}  // namespace glint
