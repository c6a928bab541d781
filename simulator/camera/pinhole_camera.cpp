// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/pinhole_camera.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <Eigen/LU>

#include "core/error.h"

namespace glint {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Blames the radial terms when they alone fold the image at about the same radius.
Problem fold_problem(double first_fold, double radial_fold) {
  if (std::isfinite(radial_fold) && first_fold > 0.9 * radial_fold) {
    return {.key = "camera.k1",
            .text = fmt::format("the radial distortion folds the image at x/z radius {:.4f}",
                                radial_fold)};
  }
  if (std::isfinite(first_fold)) {
    return {.key = "camera.p1",
            .text = fmt::format("the distortion folds the image at x/z radius {:.4f}", first_fold)};
  }
  return {.key = "camera.p1", .text = "the tangential distortion folds the image"};
}

}  // namespace

PinholeCamera::PinholeCamera(const PinholeIntrinsics& intrinsics) : intrinsics_(intrinsics) {
  const PinholeIntrinsics& in = intrinsics_;
  if (in.width_px <= 0 || in.height_px <= 0) {
    throw ConfigError(
        "camera.width_px",
        fmt::format("the image is {} x {} px, both must be > 0", in.width_px, in.height_px));
  }
  if (!(in.focal_px.x() > 0.0) || !(in.focal_px.y() > 0.0)) {
    throw ConfigError("camera.focal_mm",
                      fmt::format("gives a focal length of {} px, must be > 0",
                                  std::min(in.focal_px.x(), in.focal_px.y())));
  }
  for (const double k : in.radial) {
    is_distorted_ = is_distorted_ || k != 0.0;
  }
  for (const double p : in.tangential) {
    is_distorted_ = is_distorted_ || p != 0.0;
  }
  distortion_ = {.radial = in.radial, .tangential = in.tangential};
  max_radius_ = radial_fold_radius(in.radial);
  check_whole_image();
}

void PinholeCamera::check_whole_image() const {
  const bool is_tangential = intrinsics_.tangential[0] != 0.0 || intrinsics_.tangential[1] != 0.0;
  // A radial fold reaches a corner first; a tangential one may reach the border anywhere.
  const int steps = is_tangential ? 64 : 16;
  const double first_fold = is_tangential ? fold_radius(distortion_) : max_radius_;
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i <= steps; ++i) {
      const Vector2d pixel(intrinsics_.width_px * static_cast<double>(i) / steps,
                           intrinsics_.height_px * static_cast<double>(j) / steps);
      const std::optional<Vector2d> place = undistort(normalised(pixel));
      if (place &&
          (!is_tangential || place->norm() < first_fold || is_before_fold(distortion_, *place))) {
        continue;
      }
      Problem problem = fold_problem(first_fold, max_radius_);
      problem.text += fmt::format(
          ", before the pixel ({:g}, {:g}); allowed are k1, k2, k3, p1, p2 that grow up to there",
          pixel.x(),
          pixel.y());
      throw ConfigError(problem);
    }
  }
}

Vector2d PinholeCamera::normalised(const Vector2d& pixel_px) const {
  return (pixel_px - intrinsics_.center_px).cwiseQuotient(intrinsics_.focal_px);
}

namespace {

Vector2d no_longer_than(double limit, Vector2d move) {
  if (move.norm() > limit) {
    move *= limit / move.norm();
  }
  return move;
}

}  // namespace

std::optional<Vector2d> PinholeCamera::undistort(const Vector2d& distorted) const {
  if (!is_distorted_) {
    return distorted;
  }
  constexpr int kMaxSteps = 50;
  Vector2d guess = distorted;
  if (guess.norm() > max_radius_) {
    guess *= 0.9 * max_radius_ / guess.norm();
  }
  const double tolerance = 1e-10 / intrinsics_.focal_px.maxCoeff();
  for (int step = 0; step < kMaxSteps; ++step) {
    Matrix2d jacobian;
    const Vector2d residual = distort(distortion_, guess, &jacobian) - distorted;
    if (residual.norm() < tolerance) {
      return guess.norm() <= max_radius_ ? std::optional(guess) : std::nullopt;
    }
    const double determinant = jacobian.determinant();
    if (std::abs(determinant) < 1e-12) {
      return std::nullopt;
    }
    guess -= no_longer_than(0.5 * std::max(0.1, guess.norm()), jacobian.inverse() * residual);
  }
  return std::nullopt;
}

std::optional<Vector2d> PinholeCamera::project(const Vector3d& point_in_camera_mm) const {
  if (!(point_in_camera_mm.z() > 0.0)) {
    return std::nullopt;
  }
  const Vector2d place = point_in_camera_mm.head<2>() / point_in_camera_mm.z();
  if (place.norm() > max_radius_) {
    return std::nullopt;
  }
  return Vector2d(intrinsics_.focal_px.cwiseProduct(distort(distortion_, place, nullptr)) +
                  intrinsics_.center_px);
}

std::optional<Vector3d> PinholeCamera::ray_through(const Vector2d& pixel_px) const {
  const std::optional<Vector2d> place = undistort(normalised(pixel_px));
  if (!place) {
    return std::nullopt;
  }
  return Vector3d(place->x(), place->y(), 1.0).normalized();
}

}  // namespace glint
