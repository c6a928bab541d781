// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/surrogate/gaussian_process.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>

#include "core/error.h"

namespace glint {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Normal prior of the logarithm of a parameter, and its box.
struct Prior {
  double mean = 0.0;
  double sigma = 1.0;
  double low = 0.0;
  double high = 1.0;
};

constexpr Prior kLength = {-0.7, 1.0, -3.5, 3.0};
constexpr Prior kSignal = {0.0, 1.0, -3.0, 3.0};
constexpr Prior kNoise = {-4.0, 2.0, -18.0, 0.7};
constexpr Prior kTinyNoise = {-12.0, 2.0, -18.0, 0.7};
constexpr Prior kShare = {0.0, 1.0, -4.0, 4.0};
constexpr double kFirstJitter = 1e-10;
constexpr double kMaxJitter = 1e-2;
constexpr double kNoLoss = 1e10;

std::vector<Prior> priors_of(const Encoding& encoding, bool is_noisy) {
  std::vector<Prior> priors(static_cast<std::size_t>(encoding.num_lengths()), kLength);
  priors.push_back(kSignal);
  priors.push_back(is_noisy ? kNoise : kTinyNoise);
  if (encoding.has_branches()) {
    priors.push_back(kShare);
  }
  return priors;
}

KernelParameters prior_means(const std::vector<Prior>& priors) {
  KernelParameters means(static_cast<Index>(priors.size()));
  std::ranges::transform(priors, means.begin(), &Prior::mean);
  return means;
}

double squared(double x) {
  return x * x;
}

/// The constant that fits best: ones' inverse values / ones' inverse ones.
double best_mean(const VectorXd& inverse_ones, const VectorXd& values) {
  return inverse_ones.dot(values) / std::max(inverse_ones.sum(), 1e-300);
}

}  // namespace

GaussianProcess::GaussianProcess(const SearchSpace& space, GaussianProcessSettings settings)
    : encoding_(space),
      settings_(settings),
      parameters_(prior_means(priors_of(encoding_, settings.is_noisy))) {}

void GaussianProcess::fit(std::span<const Point> points,
                          std::span<const double> values,
                          std::span<const double> errors) {
  set_data(points, values, errors);
  const KernelParameters fresh = prior_means(priors_of(encoding_, settings_.is_noisy));
  KernelParameters best = fitted_from(parameters_);
  if (parameters_ != fresh && num_points() <= settings_.max_fresh_points) {
    const KernelParameters other = fitted_from(fresh);
    VectorXd unused(best.size());
    if (loss(other, unused) < loss(best, unused)) {
      best = other;
    }
  }
  parameters_ = best;
  factorise();
  solve();
}

void GaussianProcess::set(const KernelParameters& parameters,
                          std::span<const Point> points,
                          std::span<const double> values,
                          std::span<const double> errors) {
  GLINT_CHECK(parameters.size() == num_parameters(encoding_), "parameters of this space");
  set_data(points, values, errors);
  parameters_ = parameters;
  factorise();
  solve();
}

void GaussianProcess::set_data(std::span<const Point> points,
                               std::span<const double> values,
                               std::span<const double> errors) {
  GLINT_CHECK(!points.empty() && points.size() == values.size(), "one value per point");
  GLINT_CHECK(errors.empty() || errors.size() == values.size(), "one error per value, or none");
  rows_ = encoding_.rows(points);
  const Eigen::Map<const VectorXd> given(values.data(), static_cast<Index>(values.size()));
  GLINT_CHECK(given.allFinite(), "values are finite");
  offset_ = given.mean();
  const double spread = std::sqrt((given.array() - offset_).square().mean());
  const double tiny = 1e-12 * (1.0 + std::abs(offset_));
  scale_ = spread > tiny ? spread : 1.0;
  values_ = (given.array() - offset_) / scale_;
  own_noise_ = VectorXd::Zero(values_.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    own_noise_[static_cast<Index>(i)] =
        std::isfinite(errors[i]) ? squared(errors[i] / scale_) : 0.0;
  }
}

/// Minus the logarithm of likelihood times prior, and its gradient.
double GaussianProcess::loss(const KernelParameters& parameters, VectorXd& gradient) const {
  const double noise = noise_variance(encoding_, parameters);
  MatrixXd k = covariance(encoding_, parameters, rows_, rows_);
  k.diagonal().array() += own_noise_.array() + noise + kFirstJitter;
  const Eigen::LLT<MatrixXd> factor(k);
  gradient.setZero(parameters.size());
  if (factor.info() != Eigen::Success) {
    return kNoLoss;
  }
  MatrixXd inverse = factor.solve(MatrixXd::Identity(k.rows(), k.cols()));
  const double mean = best_mean(inverse.rowwise().sum(), values_);
  const VectorXd residuals = (values_.array() - mean).matrix();
  const VectorXd weights = inverse * residuals;
  double result = 0.5 * residuals.dot(weights);
  result += factor.matrixLLT().diagonal().array().log().sum();
  const MatrixXd b = weights * weights.transpose() - inverse;
  gradient = -half_trace_of_derivative(encoding_, parameters, rows_, b);
  gradient[encoding_.num_lengths() + 1] -= 0.5 * noise * b.trace();
  const std::vector<Prior> priors = priors_of(encoding_, settings_.is_noisy);
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const double z = (parameters[static_cast<Index>(i)] - priors[i].mean) / priors[i].sigma;
    result += 0.5 * z * z;
    gradient[static_cast<Index>(i)] += z / priors[i].sigma;
  }
  return result;
}

KernelParameters GaussianProcess::fitted_from(const KernelParameters& start) const {
  struct Search {
    const GaussianProcess* process;
    double best_loss = std::numeric_limits<double>::infinity();
    std::vector<double> best;
  };

  const std::vector<Prior> priors = priors_of(encoding_, settings_.is_noisy);
  std::vector<double> x(start.begin(), start.end());
  std::vector<double> low;
  std::vector<double> high;
  for (std::size_t i = 0; i < priors.size(); ++i) {
    low.push_back(priors[i].low);
    high.push_back(priors[i].high);
    x[i] = std::clamp(x[i], low[i], high[i]);
  }
  Search search{.process = this, .best = x};
  nlopt::opt optimizer(nlopt::LD_LBFGS, static_cast<unsigned>(x.size()));
  optimizer.set_lower_bounds(low);
  optimizer.set_upper_bounds(high);
  optimizer.set_maxeval(settings_.max_steps);
  optimizer.set_ftol_abs(1e-3);
  optimizer.set_min_objective(
      [](const std::vector<double>& at, std::vector<double>& slope, void* data) {
        Search& own = *static_cast<Search*>(data);
        const Eigen::Map<const VectorXd> parameters(at.data(), static_cast<Index>(at.size()));
        VectorXd gradient(parameters.size());
        const double value = own.process->loss(parameters, gradient);
        if (value < own.best_loss) {
          own.best_loss = value;
          own.best = at;
        }
        std::ranges::copy(gradient, slope.begin());
        return value;
      },
      &search);
  try {
    double unused = 0.0;
    optimizer.optimize(x, unused);
  } catch (const std::exception&) {
    // It stopped for rounding; the best one seen counts.
  }
  return Eigen::Map<const VectorXd>(search.best.data(), static_cast<Index>(search.best.size()));
}

void GaussianProcess::factorise() {
  MatrixXd k = covariance(encoding_, parameters_, rows_, rows_);
  k.diagonal().array() += own_noise_.array() + noise_variance(encoding_, parameters_);
  for (jitter_ = kFirstJitter; jitter_ <= kMaxJitter; jitter_ *= 10.0) {
    MatrixXd shifted = k;
    shifted.diagonal().array() += jitter_;
    const Eigen::LLT<MatrixXd> factor(shifted);
    if (factor.info() == Eigen::Success) {
      factor_ = factor.matrixL();
      return;
    }
  }
  GLINT_CHECK(false, "a covariance with jitter can be factorised");
}

void GaussianProcess::solve() {
  const auto lower = factor_.triangularView<Eigen::Lower>();
  const auto upper = factor_.transpose().triangularView<Eigen::Upper>();
  const auto solved = [&](const VectorXd& right) -> VectorXd {
    return upper.solve(VectorXd(lower.solve(right)));
  };
  mean_ = best_mean(solved(VectorXd::Ones(values_.size())), values_);
  weights_ = solved((values_.array() - mean_).matrix());
}

void GaussianProcess::add(const Point& point, double value, std::optional<double> error) {
  GLINT_CHECK(values_.size() > 0 && std::isfinite(value), "a fit, then finite values");
  const Index n = values_.size();
  const MatrixXd row = encoding_.row(point);
  const double own = error && std::isfinite(*error) ? squared(*error / scale_) : 0.0;
  const VectorXd k = covariance(encoding_, parameters_, rows_, row);
  const VectorXd l = factor_.triangularView<Eigen::Lower>().solve(k);
  const double noise = noise_variance(encoding_, parameters_) + own + jitter_;
  const double rest = signal_variance(encoding_, parameters_) + noise - l.squaredNorm();
  rows_.conservativeResize(n + 1, Eigen::NoChange);
  rows_.row(n) = row;
  values_.conservativeResize(n + 1);
  values_[n] = (value - offset_) / scale_;
  own_noise_.conservativeResize(n + 1);
  own_noise_[n] = own;
  factor_.conservativeResize(n + 1, n + 1);
  factor_.row(n).head(n) = l.transpose();
  factor_.col(n).setZero();
  factor_(n, n) = std::sqrt(std::max(rest, 0.5 * noise));
  solve();
}

Eigen::MatrixX2d GaussianProcess::predict_rows(const MatrixXd& rows) const {
  const MatrixXd k = covariance(encoding_, parameters_, rows_, rows);
  const MatrixXd half = factor_.triangularView<Eigen::Lower>().solve(k);
  const double signal = signal_variance(encoding_, parameters_);
  Eigen::MatrixX2d result(rows.rows(), 2);
  result.col(0) = (offset_ + scale_ * ((k.transpose() * weights_).array() + mean_)).matrix();
  result.col(1) = (squared(scale_) *
                   (signal - half.colwise().squaredNorm().transpose().array()).max(1e-14 * signal))
                      .matrix();
  return result;
}

SlopedPosterior GaussianProcess::predict_with_slopes(const MatrixXd& rows) const {
  const MatrixXd k = covariance(encoding_, parameters_, rows_, rows);
  MatrixXd solved = factor_.triangularView<Eigen::Lower>().solve(k);
  const double signal = signal_variance(encoding_, parameters_);
  const VectorXd left = signal - solved.colwise().squaredNorm().transpose().array();
  factor_.triangularView<Eigen::Lower>().adjoint().solveInPlace(solved);
  const std::vector<MatrixXd> weights = {weights_.replicate(1, rows.rows()), std::move(solved)};
  std::vector<MatrixXd> slopes = weighted_slopes(encoding_, parameters_, rows_, rows, weights);
  return {.mean = (offset_ + scale_ * ((k.transpose() * weights_).array() + mean_)).matrix(),
          .variance = squared(scale_) * left.cwiseMax(1e-14 * signal),
          .mean_slopes = scale_ * slopes[0],
          .variance_slopes = -2.0 * squared(scale_) * slopes[1]};
}

std::vector<Posterior> GaussianProcess::predict(std::span<const Point> points) const {
  const Eigen::MatrixX2d both = predict_rows(encoding_.rows(points));
  std::vector<Posterior> result;
  for (Index i = 0; i < both.rows(); ++i) {
    result.push_back({both(i, 0), both(i, 1)});
  }
  return result;
}

Posterior GaussianProcess::predict(const Point& point) const {
  return predict(std::span(&point, 1)).front();
}

std::vector<double> GaussianProcess::predict_means(std::span<const Point> points) const {
  const MatrixXd k = covariance(encoding_, parameters_, rows_, encoding_.rows(points));
  const VectorXd means = (offset_ + scale_ * ((k.transpose() * weights_).array() + mean_)).matrix();
  return {means.begin(), means.end()};
}

/// The covariance without its noise, times the weights.
VectorXd GaussianProcess::means_at_points() const {
  const double noise = noise_variance(encoding_, parameters_) + jitter_;
  const VectorXd pulled = ((own_noise_.array() + noise) * weights_.array()).matrix();
  return (offset_ + scale_ * (values_ - pulled).array()).matrix();
}

JointPosterior GaussianProcess::predict_jointly(std::span<const Point> points) const {
  const MatrixXd rows = encoding_.rows(points);
  const MatrixXd k = covariance(encoding_, parameters_, rows_, rows);
  const MatrixXd half = factor_.triangularView<Eigen::Lower>().solve(k);
  const MatrixXd prior = covariance(encoding_, parameters_, rows, rows);
  return {(offset_ + scale_ * ((k.transpose() * weights_).array() + mean_)).matrix(),
          squared(scale_) * (prior - half.transpose() * half)};
}

std::vector<Posterior> GaussianProcess::leave_one_out() const {
  const auto lower = factor_.triangularView<Eigen::Lower>();
  const MatrixXd half = lower.solve(MatrixXd::Identity(factor_.rows(), factor_.cols()));
  std::vector<Posterior> result;
  for (Index i = 0; i < values_.size(); ++i) {
    const double precision = half.col(i).squaredNorm();
    const double mean = values_[i] - weights_[i] / precision;
    result.push_back({offset_ + scale_ * mean, squared(scale_) / precision});
  }
  return result;
}

double GaussianProcess::leave_one_out_q2() const {
  double errors = 0.0;
  const std::vector<Posterior> expected = leave_one_out();
  for (Index i = 0; i < values_.size(); ++i) {
    const double value = offset_ + scale_ * values_[i];
    errors += squared(value - expected[static_cast<std::size_t>(i)].mean);
  }
  const double deviations = squared(scale_) * (values_.array() - values_.mean()).square().sum();
  const double tiny = 1e-20 * squared(scale_);
  return deviations > tiny ? 1.0 - errors / deviations : 0.0;
}

double GaussianProcess::noise() const {
  return scale_ * std::sqrt(noise_variance(encoding_, parameters_));
}

}  // namespace glint
