// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/lens_vector.h"

#include "core/error.h"
#include "simulator/camera/distortion.h"

namespace glint {
namespace {

Distortion distortion_of(const LensVector& lens) {
  return {.radial = {lens[4], lens[5], lens[6]}, .tangential = {lens[7], lens[8]}};
}

/// How the distorted point moves with k1 k2 k3 p1 p2.
Eigen::Matrix<double, 2, 5> by_coefficients(const Eigen::Vector2d& at) {
  const double x = at.x();
  const double y = at.y();
  const double s = at.squaredNorm();
  Eigen::Matrix<double, 2, 5> result;
  result << x * s, x * s * s, x * s * s * s, 2 * x * y, s + 2 * x * x,  //
      y * s, y * s * s, y * s * s * s, s + 2 * y * y, 2 * x * y;
  return result;
}

}  // namespace

LensVector lens_vector(const PinholeIntrinsics& intrinsics) {
  LensVector lens;
  lens << intrinsics.focal_px, intrinsics.center_px, intrinsics.radial[0], intrinsics.radial[1],
      intrinsics.radial[2], intrinsics.tangential[0], intrinsics.tangential[1];
  return lens;
}

PinholeIntrinsics intrinsics_from(const LensVector& lens, int width_px, int height_px) {
  return {.width_px = width_px,
          .height_px = height_px,
          .focal_px = lens.head<2>(),
          .center_px = lens.segment<2>(2),
          .radial = {lens[4], lens[5], lens[6]},
          .tangential = {lens[7], lens[8]}};
}

std::optional<Eigen::Vector2d> project_by_lens(const LensVector& lens,
                                               const Eigen::Vector3d& point_in_camera_mm,
                                               LensDerivatives* derivatives) {
  const double z = point_in_camera_mm.z();
  if (!(z > 0.0)) {
    return std::nullopt;
  }
  const Eigen::Vector2d at = point_in_camera_mm.head<2>() / z;
  Eigen::Matrix2d by_at;
  const Eigen::Vector2d bent =
      distort(distortion_of(lens), at, derivatives != nullptr ? &by_at : nullptr);
  if (derivatives != nullptr) {
    const Eigen::DiagonalMatrix<double, 2> focal(lens[0], lens[1]);
    derivatives->by_lens.setZero();
    derivatives->by_lens.leftCols<2>() = bent.asDiagonal();
    derivatives->by_lens.middleCols<2>(2).setIdentity();
    derivatives->by_lens.rightCols<5>() = focal * by_coefficients(at);
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << 1.0 / z, 0.0, -at.x() / z, 0.0, 1.0 / z, -at.y() / z;
    derivatives->by_point = focal * (by_at * by_point);
  }
  return Eigen::Vector2d(lens[0] * bent.x() + lens[2], lens[1] * bent.y() + lens[3]);
}

bool is_possible_lens(const LensVector& lens, int width_px, int height_px) {
  if (!lens.allFinite()) {
    return false;
  }
  try {
    const PinholeCamera camera(intrinsics_from(lens, width_px, height_px));
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

}  // namespace glint
