// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/variance_components.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace glint {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

const Vector3d min_sizes(1e-5, 1e-7, 1e-5);

bool has_limits(const NoiseSizes& noise) {
  return noise.robot_rad > 0.0 && noise.robot_mm > 0.0;
}

/// Logarithms of corner_px, robot_rad, robot_mm, then w with pattern_px = corner_px sqrt(1 + w^2).
NoiseSizes noise_of(const Vector4d& at) {
  const Vector3d sizes = at.head<3>().array().exp().matrix().cwiseMax(min_sizes);
  return {.corner_px = sizes[0],
          .robot_rad = sizes[1],
          .robot_mm = sizes[2],
          .pattern_px = sizes[0] * std::hypot(1.0, at[3])};
}

/// Inverse of noise_of(). Where patterns are not known to be worse than corners w starts at one: at
/// zero the likelihood has no derivative.
Vector4d coordinates_of(const NoiseSizes& noise) {
  const Vector3d sizes(noise.corner_px, noise.robot_rad, noise.robot_mm);
  const double ratio = noise.whole_pattern_px() / noise.corner_px;
  Vector4d at;
  at << sizes.cwiseMax(min_sizes).array().log().matrix(),
      noise.pattern_px > 0.0 ? std::sqrt(std::max(0.01, ratio * ratio - 1.0)) : 1.0;
  return at;
}

double log_determinant(const Eigen::LDLT<MatrixXd>& solved) {
  return solved.vectorD().array().abs().max(1e-300).log().sum();
}

/// Scales a Hessian to a unit diagonal before it is factored: its unknowns have different units.
struct ScaledFactor {
  explicit ScaledFactor(const MatrixXd& hessian)
      : scale(hessian.diagonal().array().max(1e-300).rsqrt()),
        factor(scale.asDiagonal() * hessian * scale.asDiagonal()) {}

  VectorXd solve(const VectorXd& right) const {
    return scale.cwiseProduct(factor.solve(scale.cwiseProduct(right)));
  }

  double log_det() const { return log_determinant(factor) - 2.0 * scale.array().log().sum(); }

  VectorXd scale;
  Eigen::LDLT<MatrixXd> factor;
};

double minus_two_log_likelihood(const Bundle& bundle,
                                const CompressedBundle& compressed,
                                const Vector4d& at) {
  return shared_information(bundle, compressed, noise_of(at)).minus_two_log_likelihood;
}

struct Derivatives {
  Vector4d gradient = Vector4d::Zero();
  Eigen::Matrix4d hessian = Eigen::Matrix4d::Zero();
};

/// By central differences: the likelihood is smooth in the coordinates.
template <class Function>
Derivatives derivatives_at(const Vector4d& at, const Function& function) {
  constexpr double kStep = 1e-2;
  Derivatives derivatives;
  const double middle = function(at);
  for (int i = 0; i < 4; ++i) {
    const Vector4d a = kStep * Vector4d::Unit(i);
    const double up = function(at + a);
    const double down = function(at - a);
    derivatives.gradient[i] = (up - down) / (2.0 * kStep);
    derivatives.hessian(i, i) = (up - 2.0 * middle + down) / (kStep * kStep);
    for (int j = 0; j < i; ++j) {
      const Vector4d b = kStep * Vector4d::Unit(j);
      const double mixed = (function(at + a + b) - function(at + a - b) - function(at - a + b) +
                            function(at - a - b)) /
                           (4.0 * kStep * kStep);
      derivatives.hessian(i, j) = derivatives.hessian(j, i) = mixed;
    }
  }
  return derivatives;
}

/// A step of Newton with the curvature made positive, at most one in each coordinate.
Vector4d newton_step(const Derivatives& derivatives) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(derivatives.hessian);
  const Vector4d curvature = eigen.eigenvalues().cwiseAbs().cwiseMax(1e-2);
  const Vector4d along = eigen.eigenvectors().transpose() * derivatives.gradient;
  const Vector4d step = -eigen.eigenvectors() * along.cwiseQuotient(curvature);
  return step / std::max(1.0, step.cwiseAbs().maxCoeff());
}

EstimatedNoise corner_noise_only(const Bundle& bundle, const CompressedBundle& compressed) {
  const double freedom = std::max(1.0, compressed.rest_count - num_shared(bundle));
  // At the minimum the shared unknowns explain nothing more; elsewhere their step's part goes.
  MatrixXd hessian = compressed.rest_hessian;
  VectorXd gradient = compressed.rest_gradient;
  const double explained =
      gradient.size() > 0 ? gradient.dot(ScaledFactor(hessian).solve(gradient)) : 0.0;
  const double square = std::max(0.0, compressed.rest_square_px2 - explained);
  NoiseSizes noise = bundle.noise;
  noise.corner_px = std::max(min_sizes[0], std::sqrt(square / freedom));
  return {.noise = noise, .log_sigma = Vector3d(std::sqrt(0.5 / freedom), 0.0, 0.0)};
}

}  // namespace

CompressedBundle compress(const Bundle& bundle) {
  const Eigen::Index size = num_shared(bundle);
  CompressedBundle result{.rest_hessian = MatrixXd::Zero(size, size),
                          .rest_gradient = VectorXd::Zero(size)};
  for (const BundleView& view : bundle.views) {
    const auto system = weighted_system(bundle, view);
    if (!system.has_value()) {
      continue;
    }
    const Eigen::Index rows = system->residual_px.size();
    const Eigen::HouseholderQR<MatrixXd> qr(system->by_error);
    const MatrixXd q = qr.householderQ() * MatrixXd::Identity(rows, 6);
    const VectorXd y = system->residual_px - system->by_error * view.error;
    CompressedBundle::View& compressed = result.views.emplace_back();
    compressed.reached = q.transpose() * y;
    compressed.by_shared = q.transpose() * system->by_shared;
    compressed.by_error = qr.matrixQR().topRows<6>().triangularView<Eigen::Upper>();
    // Subtracted before the products: the rest is small against the whole.
    const VectorXd rest = y - q * compressed.reached;
    const MatrixXd rest_by = system->by_shared - q * compressed.by_shared;
    result.rest_hessian += rest_by.transpose() * rest_by;
    result.rest_gradient += rest_by.transpose() * rest;
    result.rest_square_px2 += rest.squaredNorm();
    result.rest_count += static_cast<double>(rows - 6);
  }
  return result;
}

SharedInformation shared_information(const Bundle& bundle,
                                     const CompressedBundle& compressed,
                                     const NoiseSizes& noise) {
  const double variance = noise.corner_px * noise.corner_px;
  const double pattern = noise.whole_pattern_px() * noise.whole_pattern_px();
  SharedInformation result{.hessian = compressed.rest_hessian / variance,
                           .gradient = compressed.rest_gradient / variance};
  double sum = compressed.rest_count * std::log(variance) + compressed.rest_square_px2 / variance;
  if (has_limits(noise)) {
    Vector6d robot;
    robot << Vector3d::Constant(noise.robot_rad), Vector3d::Constant(noise.robot_mm);
    for (const CompressedBundle::View& view : compressed.views) {
      const Matrix6d moved = view.by_error * robot.asDiagonal();
      const Matrix6d covariance = moved * moved.transpose() + pattern * Matrix6d::Identity();
      const Eigen::LLT<Matrix6d> root(covariance);
      const Eigen::Matrix<double, 6, Eigen::Dynamic> by = root.matrixL().solve(view.by_shared);
      const Vector6d reached = root.matrixL().solve(view.reached);
      result.hessian += by.transpose() * by;
      result.gradient += by.transpose() * reached;
      sum += 2.0 * root.matrixLLT().diagonal().array().log().sum() + reached.squaredNorm();
    }
  }
  add_lens_prior(bundle, result.hessian, result.gradient);
  if (result.gradient.size() > 0) {
    const ScaledFactor factor(result.hessian);
    sum += factor.log_det() - result.gradient.dot(factor.solve(result.gradient));
  }
  result.minus_two_log_likelihood = sum;
  return result;
}

MatrixXd inverse_information(const MatrixXd& hessian) {
  if (hessian.rows() == 0) {
    return hessian;
  }
  const VectorXd scale = hessian.diagonal().array().max(1e-300).rsqrt();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * hessian *
                                                      scale.asDiagonal());
  const VectorXd values = eigen.eigenvalues().cwiseMax(1e-16 * eigen.eigenvalues().maxCoeff());
  const MatrixXd inverse =
      eigen.eigenvectors() * values.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

EstimatedNoise estimate_noise(const Bundle& bundle) {
  const CompressedBundle compressed = compress(bundle);
  if (!has_limits(bundle.noise)) {
    return corner_noise_only(bundle, compressed);
  }
  const auto function = [&](const Vector4d& at) {
    return minus_two_log_likelihood(bundle, compressed, at);
  };
  Vector4d at = coordinates_of(bundle.noise);
  double value = function(at);
  Derivatives derivatives;
  for (int round = 0; round < 60; ++round) {
    derivatives = derivatives_at(at, function);
    Vector4d step = newton_step(derivatives);
    double stepped = function(at + step);
    for (int halved = 0; halved < 20 && !(stepped <= value); ++halved) {
      step *= 0.5;
      stepped = function(at + step);
    }
    if (!(stepped <= value)) {
      break;
    }
    at += step;
    // A size that only falls ends at its least.
    at.head<3>() = at.head<3>().cwiseMax(Vector3d(min_sizes.array().log()));
    const bool is_done = value - stepped < 1e-6;
    value = function(at);
    if (is_done) {
      break;
    }
  }
  const Eigen::Matrix3d information =
      0.5 * derivatives.hessian.topLeftCorner<3, 3>() + 1e-3 * Eigen::Matrix3d::Identity();
  const Vector3d variances = information.inverse().diagonal();
  return {.noise = noise_of(at), .log_sigma = variances.cwiseMax(0.0).cwiseSqrt()};
}

}  // namespace glint
