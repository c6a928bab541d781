// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/upkeep/pixel_error.h"

#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>

#include "hardware/calibration/rotation.h"
#include "simulator/camera/pinhole_camera.h"

namespace glint {
namespace {

using Eigen::Vector2d;

/// How the place of a ray moves with the intrinsics and with a turn of the camera.
struct RayMotion {
  Eigen::Matrix<double, 2, 9> by_lens;
  Eigen::Matrix<double, 2, 3> by_turn;
};

std::optional<RayMotion> ray_motion(const PinholeCamera& camera,
                                    const LensVector& lens,
                                    const Vector2d& pixel_px) {
  const auto ray = camera.ray_through(pixel_px);
  LensDerivatives derivatives;
  if (!ray || !project_by_lens(lens, *ray, &derivatives)) {
    return std::nullopt;
  }
  return RayMotion{.by_lens = derivatives.by_lens,
                   .by_turn = derivatives.by_point * -cross_matrix(*ray)};
}

/// The turn that makes up best, over the whole picture, for a change of the intrinsics.
Eigen::Matrix<double, 3, 9> best_turn(const PinholeCamera& camera,
                                      const LensVector& lens,
                                      const Vector2d& size_px) {
  constexpr int kGrid = 7;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 9> right = Eigen::Matrix<double, 3, 9>::Zero();
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const int row = i / kGrid;
    const Vector2d share((i % kGrid + 0.5) / kGrid, (row + 0.5) / kGrid);
    if (const auto motion = ray_motion(camera, lens, size_px.cwiseProduct(share))) {
      normal += motion->by_turn.transpose() * motion->by_turn;
      right -= motion->by_turn.transpose() * motion->by_lens;
    }
  }
  return normal.ldlt().solve(right);
}

}  // namespace

std::vector<double> ray_errors_px(const LensVector& lens,
                                  const Eigen::Matrix<double, 9, 9>& covariance,
                                  const Eigen::Vector2i& size_px,
                                  std::span<const Vector2d> pixels_px) {
  const PinholeCamera camera(intrinsics_from(lens, size_px.x(), size_px.y()));
  const Eigen::Matrix<double, 3, 9> turn = best_turn(camera, lens, size_px.cast<double>());
  std::vector<double> errors;
  for (const Vector2d& pixel : pixels_px) {
    const auto motion = ray_motion(camera, lens, pixel);
    if (!motion) {
      errors.push_back(std::numeric_limits<double>::infinity());
      continue;
    }
    const Eigen::Matrix<double, 2, 9> by = motion->by_lens + motion->by_turn * turn;
    errors.push_back(std::sqrt((by * covariance * by.transpose()).trace()));
  }
  return errors;
}

}  // namespace glint
