// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/pinhole_camera.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/LU>

#include "core/error.h"

namespace glint {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// d/dr of r (1 + k1 r^2 + k2 r^4 + k3 r^6): where it is not positive the image folds.
double radial_slope(const std::array<double, 3>& k, double radius) {
  const double s = radius * radius;
  return 1.0 + s * (3.0 * k[0] + s * (5.0 * k[1] + s * 7.0 * k[2]));
}

/// The smallest radius at which the radial distortion turns back, by a scan and bisection.
double turning_radius(const std::array<double, 3>& k) {
  constexpr double kStep = 1e-3;
  constexpr int kSteps = 20000;
  for (int i = 1; i <= kSteps; ++i) {
    if (radial_slope(k, i * kStep) > 0.0) {
      continue;
    }
    double low = (i - 1) * kStep;
    double high = i * kStep;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (radial_slope(k, middle) > 0.0 ? low : high) = middle;
    }
    return low;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

PinholeCamera::PinholeCamera(const PinholeIntrinsics& intrinsics) : intrinsics_(intrinsics) {
  const PinholeIntrinsics& in = intrinsics_;
  if (in.width_px <= 0 || in.height_px <= 0) {
    throw ConfigError(fmt::format(
        "camera.width_px: the image is {} x {} px, both must be > 0", in.width_px, in.height_px));
  }
  if (!(in.focal_px.x() > 0.0) || !(in.focal_px.y() > 0.0)) {
    throw ConfigError(fmt::format("camera.focal_mm: gives a focal length of {} px, must be > 0",
                                  std::min(in.focal_px.x(), in.focal_px.y())));
  }
  for (const double k : in.radial) {
    is_distorted_ = is_distorted_ || k != 0.0;
  }
  for (const double p : in.tangential) {
    is_distorted_ = is_distorted_ || p != 0.0;
  }
  max_radius_ = turning_radius(in.radial);
  check_whole_image();
}

void PinholeCamera::check_whole_image() const {
  // A folding distortion fails at the border first; the grid catches unusual ones inside.
  constexpr int kSteps = 16;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const Vector2d pixel(intrinsics_.width_px * static_cast<double>(i) / kSteps,
                           intrinsics_.height_px * static_cast<double>(j) / kSteps);
      if (ray_through(pixel)) {
        continue;
      }
      const std::string where =
          std::isfinite(max_radius_)
              ? fmt::format("camera.k1: the radial distortion folds the image at x/z radius {:.4f}",
                            max_radius_)
              : std::string("camera.p1: the tangential distortion folds the image");
      throw ConfigError(fmt::format(
          "{}, before the pixel ({:g}, {:g}); allowed are k1, k2, k3, p1, p2 that grow up to there",
          where,
          pixel.x(),
          pixel.y()));
    }
  }
}

Vector2d PinholeCamera::distort(const Vector2d& normalised, Matrix2d* jacobian) const {
  const auto& [k1, k2, k3] = intrinsics_.radial;
  const auto& [p1, p2] = intrinsics_.tangential;
  const double x = normalised.x();
  const double y = normalised.y();
  const double s = x * x + y * y;
  const double radial = 1.0 + s * (k1 + s * (k2 + s * k3));
  if (jacobian != nullptr) {
    const double d_radial = k1 + s * (2.0 * k2 + s * 3.0 * k3);  // with respect to s
    *jacobian << radial + 2 * x * x * d_radial + 2 * p1 * y + 6 * p2 * x,
        2 * x * y * d_radial + 2 * p1 * x + 2 * p2 * y,
        2 * x * y * d_radial + 2 * p1 * x + 2 * p2 * y,
        radial + 2 * y * y * d_radial + 6 * p1 * y + 2 * p2 * x;
  }
  return {x * radial + 2 * p1 * x * y + p2 * (s + 2 * x * x),
          y * radial + p1 * (s + 2 * y * y) + 2 * p2 * x * y};
}

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
    const Vector2d residual = distort(guess, &jacobian) - distorted;
    if (residual.norm() < tolerance) {
      return guess.norm() <= max_radius_ ? std::optional(guess) : std::nullopt;
    }
    const double determinant = jacobian.determinant();
    if (std::abs(determinant) < 1e-12) {
      return std::nullopt;
    }
    Vector2d move = jacobian.inverse() * residual;
    const double limit = 0.5 * std::max(0.1, guess.norm());
    if (move.norm() > limit) {
      move *= limit / move.norm();
    }
    guess -= move;
  }
  return std::nullopt;
}

std::optional<Vector2d> PinholeCamera::project(const Vector3d& point_in_camera_mm) const {
  if (!(point_in_camera_mm.z() > 0.0)) {
    return std::nullopt;
  }
  const Vector2d normalised = point_in_camera_mm.head<2>() / point_in_camera_mm.z();
  if (normalised.norm() > max_radius_) {
    return std::nullopt;
  }
  return Vector2d(intrinsics_.focal_px.cwiseProduct(distort(normalised, nullptr)) +
                  intrinsics_.center_px);
}

std::optional<Vector3d> PinholeCamera::ray_through(const Vector2d& pixel_px) const {
  const Vector2d distorted = (pixel_px - intrinsics_.center_px).cwiseQuotient(intrinsics_.focal_px);
  const std::optional<Vector2d> normalised = undistort(distorted);
  if (!normalised) {
    return std::nullopt;
  }
  return Vector3d(normalised->x(), normalised->y(), 1.0).normalized();
}

}  // namespace glint
