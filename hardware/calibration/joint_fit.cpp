// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/joint_fit.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "hardware/calibration/bundle_adjustment.h"
#include "hardware/calibration/camera_bundle.h"

namespace glint {
namespace {

/// Chi-square of 6 degrees of freedom that leaves no doubt about a board's turn.
constexpr double kSurelyRight = 30.0;

Eigen::Vector4d sizes_of(const NoiseSizes& noise) {
  return {noise.corner_px, noise.robot_rad, noise.robot_mm, noise.whole_pattern_px()};
}

/// Of the six numbers that the robot's error reaches, at the view's most likely error.
double chi_square(const Bundle& bundle) {
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  const CompressedBundle compressed = compress(bundle);
  if (compressed.views.empty()) {
    return std::numeric_limits<double>::infinity();
  }
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(bundle.noise.robot_rad),
      Eigen::Vector3d::Constant(bundle.noise.robot_mm);
  const Matrix6d moved = compressed.views[0].by_error * sigma.asDiagonal();
  const double pattern = bundle.noise.whole_pattern_px();
  const Matrix6d covariance = moved * moved.transpose() + pattern * pattern * Matrix6d::Identity();
  const Vector6d& reached = compressed.views[0].reached;
  return reached.dot(covariance.llt().solve(reached));
}

/// Turns of the board in the order of how well they fit without any error, with their rms in px.
std::vector<std::pair<double, int>> turns_by_fit(const Bundle& alone,
                                                 const BoardCorners& corners,
                                                 const Eigen::Isometry3d& base_from_flange,
                                                 const BoardSymmetry& symmetry) {
  std::vector<std::pair<double, int>> order;
  for (int turn = 0; turn < symmetry.turns; ++turn) {
    const BundleView view = joint_view(turned_corners(corners, symmetry, turn), base_from_flange);
    order.emplace_back(rms_px(alone, view), turn);
  }
  std::ranges::sort(order);
  return order;
}

}  // namespace

BundleView joint_view(const BoardCorners& corners, const Eigen::Isometry3d& base_from_flange) {
  const auto size = static_cast<Eigen::Index>(corners.board_mm.size());
  return {.corners = corners,
          .base_from_flange = base_from_flange,
          .weights = Eigen::VectorXd::Ones(size)};
}

BoardCorners turned_corners(const BoardCorners& corners, const BoardSymmetry& symmetry, int turn) {
  if (turn == 0) {
    return corners;
  }
  // Seen is camera_from_board turn: what was taken for p is at turn^-1 p.
  const Eigen::Isometry3d back = board_turn(symmetry, turn).inverse();
  BoardCorners turned = corners;
  for (Eigen::Vector3d& point : turned.board_mm) {
    point = back * point;
  }
  return turned;
}

bool fit_joint(Bundle& bundle, int rounds, EstimatedNoise* estimated) {
  for (int round = 0; round < rounds; ++round) {
    take_patterns(bundle);
    if (!adjust_bundle(bundle).has_converged) {
      return false;
    }
    const Eigen::Vector4d before = sizes_of(bundle.noise);
    const EstimatedNoise now = estimate_noise(bundle);
    bundle.noise = now.noise;
    if (estimated != nullptr) {
      *estimated = now;
    }
    const Eigen::Vector4d change = sizes_of(bundle.noise).cwiseQuotient(before).array().log();
    if (change.cwiseAbs().maxCoeff() < 1e-3) {
      return true;
    }
    weigh_corners(bundle);
  }
  take_patterns(bundle);
  return adjust_bundle(bundle).has_converged;
}

Agreement agreement_of(const Bundle& bundle,
                       const BoardCorners& corners,
                       const Eigen::Isometry3d& base_from_flange,
                       const BoardSymmetry& symmetry) {
  Bundle alone = without_views(bundle);
  alone.is_free = {};
  alone.are_poses_free = false;
  alone.lens_prior.reset();
  // The first is nearly always the right one.
  Agreement best{.chi_square = std::numeric_limits<double>::infinity(),
                 .rms_px = std::numeric_limits<double>::infinity()};
  for (const auto& [start_px, turn] : turns_by_fit(alone, corners, base_from_flange, symmetry)) {
    alone.views = {joint_view(turned_corners(corners, symmetry, turn), base_from_flange)};
    take_patterns(alone);
    if (adjust_bundle(alone).iterations == 0) {
      continue;
    }
    const double square = chi_square(alone);
    if (square < best.chi_square) {
      best = {.turn = turn,
              .chi_square = square,
              .error = alone.views[0].error,
              .rms_px = rms_px(alone, alone.views[0])};
    }
    if (best.chi_square < kSurelyRight) {
      break;
    }
  }
  return best;
}

}  // namespace glint
