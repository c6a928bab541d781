// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/camera_bundle.h"

#include <algorithm>
#include <cmath>

#include "hardware/calibration/bundle_adjustment.h"
#include "hardware/calibration/planar.h"
#include "hardware/calibration/variance_components.h"

namespace glint {

BundleView free_view(const BoardCorners& corners, const Eigen::Isometry3d& camera_from_board) {
  const auto size = static_cast<Eigen::Index>(corners.board_mm.size());
  return {.corners = corners,
          .base_from_flange = camera_from_board.inverse(),
          .weights = Eigen::VectorXd::Ones(size)};
}

Bundle camera_bundle(const LensVector& lens, const LensMask& is_free) {
  return {.lens = lens, .is_free = is_free, .noise = {.robot_rad = 0.0, .robot_mm = 0.0}};
}

Eigen::Isometry3d pose_of(const Bundle& bundle, const BundleView& view) {
  return PoseChain(bundle.mounting, bundle.poses, view.base_from_flange, {.error = view.error})
      .camera_from_board();
}

void weigh_corners(Bundle& bundle) {
  ViewSystem system;
  for (BundleView& view : bundle.views) {
    if (!evaluate_view(bundle, view, bundle.lens, {.error = view.error}, false, system)) {
      continue;
    }
    // What is left of the patterns is spread over all corners.
    const double sigma = std::hypot(bundle.noise.corner_px,
                                    bundle.noise.whole_pattern_px() *
                                        std::sqrt(6.0 / static_cast<double>(std::max<Eigen::Index>(
                                                            6, 2 * view.weights.size()))));
    for (Eigen::Index i = 0; i < view.weights.size(); ++i) {
      const double away = system.residual_px.segment<2>(2 * i).norm();
      const double ratio = 3.0 * sigma / std::max(away, 1e-12);
      view.weights[i] = std::min(1.0, ratio * ratio);
    }
  }
}

bool fit_camera(Bundle& bundle, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    if (!adjust_bundle(bundle).has_converged) {
      return false;
    }
    const double before = bundle.noise.corner_px;
    bundle.noise = estimate_noise(bundle).noise;
    if (std::abs(bundle.noise.corner_px / before - 1.0) < 1e-3) {
      break;
    }
    weigh_corners(bundle);
  }
  return true;
}

std::optional<FittedView> fit_view(const BoardCorners& corners, const LensVector& lens) {
  const auto pose = board_pose(corners, lens);
  if (!pose.has_value()) {
    return std::nullopt;
  }
  Bundle bundle = camera_bundle(lens, {});
  bundle.views.push_back(free_view(corners, *pose));
  adjust_bundle(bundle);
  return FittedView{.view = bundle.views[0], .rms_px = rms_px(bundle, bundle.views[0])};
}

}  // namespace glint
