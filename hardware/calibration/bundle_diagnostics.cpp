// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/bundle_diagnostics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>

#include "hardware/calibration/camera_bundle.h"
#include "hardware/calibration/variance_components.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Which rows of a SharedCovariance the shared unknowns of a bundle are.
std::vector<Index> rows_of(const Bundle& bundle) {
  std::vector<Index> rows;
  for (std::size_t i = 0; i < kLensSize; ++i) {
    if (bundle.is_free[i]) {
      rows.push_back(static_cast<Index>(i));
    }
  }
  for (Index i = 9; bundle.are_poses_free && i < 21; ++i) {
    rows.push_back(i);
  }
  return rows;
}

/// Where the ray of a pixel meets the board's plane, in the board's frame.
std::optional<Vector3d> on_board(const PinholeCamera& camera,
                                 const Eigen::Isometry3d& camera_from_board,
                                 const Vector2d& pixel_px) {
  const auto ray = camera.ray_through(pixel_px);
  if (!ray.has_value()) {
    return std::nullopt;
  }
  const Eigen::Isometry3d board_from_camera = camera_from_board.inverse();
  const Vector3d origin = board_from_camera.translation();
  const Vector3d direction = board_from_camera.linear() * *ray;
  const double distance = -origin.z() / direction.z();
  if (!(distance > 0.0) || !std::isfinite(distance)) {
    return std::nullopt;
  }
  return origin + distance * direction;
}

/// Mean square error of points seen at some pixels.
class ErrorSum {
 public:
  ErrorSum(const Bundle& bundle, const SharedCovariance& covariance, const PinholeCamera& camera)
      : bundle_(bundle), covariance_(covariance), camera_(camera) {}

  void add(const BundleView& view, const Vector2d& pixel_px) {
    const Eigen::Isometry3d pose =
        camera_from_board(bundle_.mounting, bundle_.poses, view.base_from_flange);
    const auto point = on_board(camera_, pose, pixel_px);
    BundleView seen{.base_from_flange = view.base_from_flange};
    if (!point.has_value()) {
      return;
    }
    seen.corners = {.board_mm = {*point}, .picture_px = {pixel_px}};
    ViewSystem system;
    if (!evaluate_view(bundle_, seen, bundle_.lens, {}, true, system)) {
      return;
    }
    Eigen::Matrix<double, 2, 21> by;
    by << system.by_lens, system.by_hand_eye, system.by_board;
    square_ += (by * covariance_ * by.transpose()).trace();
    ++count_;
  }

  double rms() const {
    return count_ > 0 ? std::sqrt(square_ / count_) : std::numeric_limits<double>::infinity();
  }

 private:
  const Bundle& bundle_;
  const SharedCovariance& covariance_;
  const PinholeCamera& camera_;
  double square_ = 0.0;
  int count_ = 0;
};

/// How the residuals move when the board grows, by central differences.
VectorXd by_scale(const Bundle& bundle, const BundleView& view) {
  constexpr double kStep = 1e-5;
  std::array<ViewSystem, 2> systems;
  for (const int side : {0, 1}) {
    BundleView scaled = view;
    for (Vector3d& point : scaled.corners.board_mm) {
      point *= 1.0 + (side == 0 ? -kStep : kStep);
    }
    evaluate_view(bundle,
                  scaled,
                  bundle.lens,
                  {.error = view.error},
                  false,
                  systems[static_cast<std::size_t>(side)]);
  }
  VectorXd slope = (systems[1].residual_px - systems[0].residual_px) / (2.0 * kStep);
  for (Index i = 0; i < view.weights.size(); ++i) {
    slope.segment<2>(2 * i) *= std::sqrt(view.weights[i]);
  }
  return slope;
}

/// Covariance of a picture's residuals with the robot's error in it.
MatrixXd residual_covariance(const Bundle& bundle, const WeightedSystem& system) {
  Vector6d robot;
  robot << Vector3d::Constant(bundle.noise.robot_rad), Vector3d::Constant(bundle.noise.robot_mm);
  const MatrixXd moved = system.by_error * robot.asDiagonal();
  MatrixXd covariance = moved * moved.transpose();
  const double corner = bundle.noise.corner_px * bundle.noise.corner_px;
  const double pattern = std::pow(bundle.noise.whole_pattern_px(), 2);
  const MatrixXd patterns = patterns_of(system);
  covariance += (pattern - corner) * patterns * patterns.transpose();
  covariance.diagonal().array() += corner;
  return covariance;
}

}  // namespace

SharedCovariance shared_covariance(const Bundle& bundle) {
  const SharedInformation information = shared_information(bundle, compress(bundle), bundle.noise);
  const MatrixXd small = inverse_information(information.hessian);
  const std::vector<Index> rows = rows_of(bundle);
  SharedCovariance covariance = SharedCovariance::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < rows.size(); ++j) {
      covariance(rows[i], rows[j]) = small(static_cast<Index>(i), static_cast<Index>(j));
    }
  }
  return covariance;
}

Bundle with_unseen(Bundle bundle) {
  constexpr double kUnseen = 5e-4;
  constexpr std::array<std::size_t, 2> kTangential = {7, 8};
  const bool is_lens_known = bundle.lens_prior.has_value() ||
                             std::ranges::none_of(bundle.is_free, [](bool free) { return free; });
  if (is_lens_known) {
    return bundle;
  }
  LensPrior prior{.sigma = LensVector::Constant(std::numeric_limits<double>::infinity())};
  for (const std::size_t term : kTangential) {
    if (!bundle.is_free[term]) {
      bundle.is_free[term] = true;
      prior.sigma[static_cast<Index>(term)] = kUnseen;
      bundle.lens_prior = prior;
    }
  }
  return bundle;
}

SharedCovariance covariance_with_unseen(const Bundle& bundle) {
  return shared_covariance(with_unseen(bundle));
}

PointError point_error(const Bundle& bundle,
                       const SharedCovariance& covariance,
                       int width_px,
                       int height_px) {
  const PinholeCamera camera(intrinsics_from(bundle.lens, width_px, height_px));
  const Vector2d size(width_px, height_px);
  ErrorSum all(bundle, covariance, camera);
  ErrorSum middle = all;
  ErrorSum corners = all;
  for (const BundleView& view : bundle.views) {
    for (int i = 0; i < 49; ++i) {
      const int row = i / 7;
      all.add(view, size.cwiseProduct(Vector2d(i % 7 + 0.5, row + 0.5)) / 7.0);
    }
    middle.add(view, 0.5 * size);
    for (int i = 0; i < 4; ++i) {
      corners.add(view, size.cwiseProduct(Vector2d(i % 2, i / 2)));
    }
  }
  return {.rms_px = all.rms(), .center_px = middle.rms(), .edge_px = corners.rms()};
}

std::vector<double> point_errors_px(const Bundle& bundle,
                                    const SharedCovariance& covariance,
                                    const Eigen::Vector2i& size_px,
                                    std::span<const Vector2d> pixels_px) {
  const PinholeCamera camera(intrinsics_from(bundle.lens, size_px.x(), size_px.y()));
  std::vector<double> errors;
  for (const Vector2d& pixel : pixels_px) {
    ErrorSum sum(bundle, covariance, camera);
    for (const BundleView& view : bundle.views) {
      sum.add(view, pixel);
    }
    errors.push_back(sum.rms());
  }
  return errors;
}

BoardScale board_scale(const Bundle& bundle) {
  const Index size = num_shared(bundle) + 1;
  MatrixXd hessian = MatrixXd::Zero(size, size);
  VectorXd gradient = VectorXd::Zero(size);
  for (const BundleView& view : bundle.views) {
    const auto system = weighted_system(bundle, view);
    if (!system.has_value()) {
      continue;
    }
    MatrixXd by(system->residual_px.size(), size);
    by << system->by_shared, by_scale(bundle, view);
    const MatrixXd solved = residual_covariance(bundle, *system).llt().solve(by);
    hessian += by.transpose() * solved;
    gradient += solved.transpose() * (system->residual_px - system->by_error * view.error);
  }
  MatrixXd shared = hessian.topLeftCorner(size - 1, size - 1);
  VectorXd by_shared = gradient.head(size - 1);
  add_lens_prior(bundle, shared, by_shared);
  gradient.head(size - 1) = by_shared;
  hessian.topLeftCorner(size - 1, size - 1) = shared;
  const MatrixXd covariance = inverse_information(hessian);
  BoardScale scale = {.factor = 1.0 - covariance.row(size - 1).dot(gradient),
                      .sigma = std::sqrt(covariance(size - 1, size - 1))};
  const std::vector<Index> rows = rows_of(bundle);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    scale.coupling[rows[i]] = covariance(static_cast<Index>(i), size - 1) / scale.sigma;
  }
  return scale;
}

}  // namespace glint
