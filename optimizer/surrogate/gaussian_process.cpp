// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/surrogate/gaussian_process.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace glint {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFirstJitter = 1e-10;
constexpr double kMaxJitter = 1e-2;
constexpr double kNoLoss = 1e10;
/// The variance of a derivative that is let go.
constexpr double kLetGo = 1e8;

double squared(double x) {
  return x * x;
}

/// The constant that fits best: ones' inverse values / ones' inverse ones.
/// @param sum  of inverse_ones over values alone
double best_mean(const VectorXd& inverse_ones, const VectorXd& values, double sum) {
  return inverse_ones.dot(values) / std::max(sum, 1e-300);
}

}  // namespace

GaussianProcess::GaussianProcess(const SearchSpace& space, GaussianProcessSettings settings)
    : encoding_(space),
      settings_(settings),
      parameters_(
          prior_means(priors_of(encoding_, settings.is_noisy, settings.takes_derivatives))) {}

void GaussianProcess::fit(std::span<const Point> points,
                          std::span<const double> values,
                          std::span<const double> errors,
                          std::span<const UnitDerivatives> derivatives) {
  set_data(points, values, errors, derivatives);
  const KernelParameters fresh = prior_means(priors());
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
                          std::span<const double> errors,
                          std::span<const UnitDerivatives> derivatives) {
  GLINT_CHECK(parameters.size() == parameters_.size(), "parameters of this space");
  set_data(points, values, errors, derivatives);
  parameters_ = parameters;
  factorise();
  solve();
}

void GaussianProcess::set_data(std::span<const Point> points,
                               std::span<const double> values,
                               std::span<const double> errors,
                               std::span<const UnitDerivatives> derivatives) {
  GLINT_CHECK(!points.empty() && points.size() == values.size(), "one value per point");
  GLINT_CHECK(errors.empty() || errors.size() == values.size(), "one error per value, or none");
  GLINT_CHECK(
      derivatives.empty() || (derivatives.size() == values.size() && settings_.takes_derivatives),
      "derivatives of every point, or none");
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
  seen_.clear();
  for (Index i = 0; i < values_.size(); ++i) {
    seen_.push_back({.point = i});
  }
  is_value_ = VectorXd::Ones(values_.size());
  has_derivatives_ = false;
  for (std::size_t i = 0; i < derivatives.size(); ++i) {
    see_derivatives(static_cast<Index>(i), derivatives[i]);
  }
}

/// Minus the logarithm of likelihood times prior, and its gradient.
double GaussianProcess::loss(const KernelParameters& parameters, VectorXd& gradient) const {
  const double noise = noise_variance(encoding_, parameters);
  MatrixXd k;
  if (has_derivatives_) {
    k = gram(parameters);
    k.diagonal().array() += kFirstJitter;
  } else {
    k = covariance(encoding_, parameters, rows_, rows_);
    k.diagonal().array() += own_noise_.array() + noise + kFirstJitter;
  }
  const Eigen::LLT<MatrixXd> factor(k);
  gradient.setZero(parameters.size());
  if (factor.info() != Eigen::Success) {
    return kNoLoss;
  }
  MatrixXd inverse = factor.solve(MatrixXd::Identity(k.rows(), k.cols()));
  const VectorXd ones =
      has_derivatives_ ? VectorXd(inverse * is_value_) : VectorXd(inverse.rowwise().sum());
  const double mean = best_mean(ones, values_, has_derivatives_ ? ones.dot(is_value_) : ones.sum());
  const VectorXd residuals = (values_.array() - mean * is_value_.array()).matrix();
  const VectorXd weights = inverse * residuals;
  double result = 0.5 * residuals.dot(weights);
  result += factor.matrixLLT().diagonal().array().log().sum();
  const MatrixXd b = weights * weights.transpose() - inverse;
  if (has_derivatives_) {
    gradient.head(num_parameters(encoding_)) = -observed_half_trace(observed(parameters), b);
    gradient[encoding_.num_lengths() + 1] -= 0.5 * noise * b.diagonal().dot(is_value_);
    const double derivative_noise = std::exp(parameters[parameters.size() - 1]);
    gradient[parameters.size() - 1] -=
        0.5 * derivative_noise * (b.trace() - b.diagonal().dot(is_value_));
  } else {
    gradient.head(num_parameters(encoding_)) =
        -half_trace_of_derivative(encoding_, parameters, rows_, b);
    gradient[encoding_.num_lengths() + 1] -= 0.5 * noise * b.trace();
  }
  return prior_loss(priors(), parameters, gradient, result);
}

std::vector<Prior> GaussianProcess::priors() const {
  return priors_of(encoding_, settings_.is_noisy, settings_.takes_derivatives);
}

KernelParameters GaussianProcess::fitted_from(const KernelParameters& start) const {
  return fitted_parameters(
      priors(),
      start,
      settings_.max_steps,
      [this](const KernelParameters& at, VectorXd& derivative) { return loss(at, derivative); });
}

void GaussianProcess::factorise() {
  const MatrixXd k = gram(parameters_);
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
  const VectorXd ones = solved(is_value_);
  mean_ = best_mean(ones, values_, has_derivatives_ ? ones.dot(is_value_) : ones.sum());
  weights_ = solved((values_.array() - mean_ * is_value_.array()).matrix());
}

void GaussianProcess::add(const Point& point,
                          double value,
                          std::optional<double> error,
                          const UnitDerivatives& derivatives) {
  GLINT_CHECK(values_.size() > 0 && std::isfinite(value), "a fit, then finite values");
  GLINT_CHECK(derivatives.empty() || settings_.takes_derivatives,
              "derivatives where they are taken");
  const double own = error && std::isfinite(*error) ? squared(*error / scale_) : 0.0;
  const Index at = rows_.rows();
  std::vector<double> targets = {(value - offset_) / scale_};
  std::vector<Observation> more = {{.point = at}};
  for (std::size_t c = 0; c < encoding_.columns().size() && !derivatives.empty(); ++c) {
    const Encoding::Column& column = encoding_.columns()[c];
    if (column.choice < 0 && std::isfinite(derivatives[column.variable])) {
      more.push_back({.point = at, .column = static_cast<Index>(c)});
      targets.push_back(derivatives[column.variable] / scale_);
    }
  }
  const Eigen::RowVectorXd row = encoding_.row(point);
  if (more.size() > 1) {
    const auto size = values_.size() + static_cast<Index>(more.size());
    factor_.conservativeResize(size, size);  // once for all of them
  }
  for (std::size_t i = 0; i < more.size(); ++i) {
    grow(row, more[i], targets[i], i == 0 ? own : 0.0);
  }
  solve();
}

/// Notes what is known of a point's derivatives. The factor is as it was.
void GaussianProcess::see_derivatives(Index point, const UnitDerivatives& derivatives) {
  for (std::size_t c = 0; c < encoding_.columns().size() && !derivatives.empty(); ++c) {
    const Encoding::Column& column = encoding_.columns()[c];
    if (column.choice < 0 && std::isfinite(derivatives[column.variable])) {
      has_derivatives_ = true;
      append({.point = point, .column = static_cast<Index>(c)},
             derivatives[column.variable] / scale_,
             0.0);
    }
  }
}

void GaussianProcess::append(const Observation& what, double value, double own_noise) {
  const Index n = values_.size();
  seen_.push_back(what);
  is_value_.conservativeResize(n + 1);
  is_value_[n] = what.column == Observation::kValue ? 1.0 : 0.0;
  values_.conservativeResize(n + 1);
  values_[n] = value;
  own_noise_.conservativeResize(n + 1);
  own_noise_[n] = own_noise;
}

Observed GaussianProcess::observed(const KernelParameters& parameters) const {
  return {.encoding = encoding_, .parameters = parameters, .points = rows_, .seen = seen_};
}

/// Covariance of what is known, without jitter.
MatrixXd GaussianProcess::gram(const KernelParameters& parameters) const {
  MatrixXd k = has_derivatives_ ? observed_covariance(observed(parameters))
                                : covariance(encoding_, parameters, rows_, rows_);
  if (has_derivatives_) {
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const auto at = static_cast<Index>(i);
      k(at, at) += own_noise_[at] + noise_of(parameters, i);
    }
  } else {
    k.diagonal().array() += own_noise_.array() + noise_variance(encoding_, parameters);
  }
  return k;
}

double GaussianProcess::noise_of(const KernelParameters& parameters,
                                 std::size_t observation) const {
  return seen_[observation].column == Observation::kValue
             ? noise_variance(encoding_, parameters)
             : std::exp(parameters[parameters.size() - 1]);
}

/// Of what is known (one row each) with the values at encoded rows.
MatrixXd GaussianProcess::covariance_with(const MatrixXd& rows) const {
  return has_derivatives_ ? observed_covariance(observed(parameters_), rows)
                          : covariance(encoding_, parameters_, rows_, rows);
}

/// The entries of values, in the order of the points.
VectorXd GaussianProcess::values_alone(const VectorXd& observations) const {
  if (!has_derivatives_) {
    return observations;
  }
  VectorXd values(rows_.rows());
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (seen_[i].column == Observation::kValue) {
      values[seen_[i].point] = observations[static_cast<Index>(i)];
    }
  }
  return values;
}

/// One more observation of a point, which is new where its value is observed.
void GaussianProcess::grow(const Eigen::RowVectorXd& row,
                           const Observation& what,
                           double value,
                           double own_noise) {
  const Index n = values_.size();
  const bool is_value = what.column == Observation::kValue;
  const VectorXd k = has_derivatives_ || !is_value
                         ? observed_covariance(observed(parameters_), row, what.column)
                         : VectorXd(covariance(encoding_, parameters_, rows_, MatrixXd(row)));
  const VectorXd l =
      factor_.rows() == n
          ? VectorXd(factor_.triangularView<Eigen::Lower>().solve(k))
          : VectorXd(factor_.topLeftCorner(n, n).triangularView<Eigen::Lower>().solve(k));
  if (is_value) {
    rows_.conservativeResize(rows_.rows() + 1, Eigen::NoChange);
    rows_.row(rows_.rows() - 1) = row;
  }
  append(what, value, own_noise);
  has_derivatives_ = has_derivatives_ || !is_value;
  const double noise = noise_of(parameters_, seen_.size() - 1) + own_noise + jitter_;
  const double prior =
      is_value ? signal_variance(encoding_, parameters_) : prior_variance(what.column);
  const double rest = prior + noise - l.squaredNorm();
  if (factor_.rows() == n) {
    factor_.conservativeResize(n + 1, n + 1);
  }
  factor_.row(n).head(n) = l.transpose();
  factor_.col(n).setZero();
  factor_(n, n) = std::sqrt(std::max(rest, 0.5 * noise));
}

/// Of a derivative at the last point.
double GaussianProcess::prior_variance(Index column) const {
  const std::vector<Observation> alone = {{.point = 0, .column = column}};
  const MatrixXd point = rows_.bottomRows(1);
  return observed_covariance(Observed{
      .encoding = encoding_, .parameters = parameters_, .points = point, .seen = alone})(0, 0);
}

int GaussianProcess::drop_contradicted_derivatives(double max_deviations) {
  if (!has_derivatives_) {
    return 0;
  }
  const auto lower = factor_.triangularView<Eigen::Lower>();
  const MatrixXd half = lower.solve(MatrixXd::Identity(factor_.rows(), factor_.cols()));
  int count = 0;
  for (Index i = 0; i < values_.size(); ++i) {
    // What is left of it without itself, in its standard deviations.
    const double deviations = std::abs(weights_[i]) / half.col(i).norm();
    if (is_value_[i] == 0.0 && deviations > max_deviations) {
      own_noise_[i] = kLetGo;
      ++count;
    }
  }
  if (count > 0) {
    factorise();
    solve();
  }
  return count;
}

Eigen::MatrixX2d GaussianProcess::predict_rows(const MatrixXd& rows) const {
  const MatrixXd k = covariance_with(rows);
  const MatrixXd half = factor_.triangularView<Eigen::Lower>().solve(k);
  const double signal = signal_variance(encoding_, parameters_);
  Eigen::MatrixX2d result(rows.rows(), 2);
  result.col(0) = (offset_ + scale_ * ((k.transpose() * weights_).array() + mean_)).matrix();
  result.col(1) = (squared(scale_) *
                   (signal - half.colwise().squaredNorm().transpose().array()).max(1e-14 * signal))
                      .matrix();
  return result;
}

PosteriorWithDerivatives GaussianProcess::predict_with_derivatives(const MatrixXd& rows) const {
  const MatrixXd k = covariance_with(rows);
  MatrixXd solved = factor_.triangularView<Eigen::Lower>().solve(k);
  const double signal = signal_variance(encoding_, parameters_);
  const VectorXd left = signal - solved.colwise().squaredNorm().transpose().array();
  factor_.triangularView<Eigen::Lower>().adjoint().solveInPlace(solved);
  const std::vector<MatrixXd> weights = {weights_.replicate(1, rows.rows()), std::move(solved)};
  std::vector<MatrixXd> derivatives =
      has_derivatives_ ? observed_derivatives(observed(parameters_), rows, weights)
                       : weighted_derivatives(encoding_, parameters_, rows_, rows, weights);
  return {.mean = (offset_ + scale_ * ((k.transpose() * weights_).array() + mean_)).matrix(),
          .variance = squared(scale_) * left.cwiseMax(1e-14 * signal),
          .mean_derivatives = scale_ * derivatives[0],
          .variance_derivatives = -2.0 * squared(scale_) * derivatives[1]};
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
  const MatrixXd k = covariance_with(encoding_.rows(points));
  const VectorXd means = (offset_ + scale_ * ((k.transpose() * weights_).array() + mean_)).matrix();
  return {means.begin(), means.end()};
}

/// The covariance without its noise, times the weights.
VectorXd GaussianProcess::means_at_points() const {
  const double noise = noise_variance(encoding_, parameters_) + jitter_;
  const VectorXd pulled = ((own_noise_.array() + noise) * weights_.array()).matrix();
  return (offset_ + scale_ * values_alone(values_ - pulled).array()).matrix();
}

VectorXd GaussianProcess::values_at_points() const {
  return (offset_ + scale_ * values_alone(values_).array()).matrix();
}

JointPosterior GaussianProcess::predict_jointly(std::span<const Point> points) const {
  const MatrixXd rows = encoding_.rows(points);
  const MatrixXd k = covariance_with(rows);
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
    if (is_value_[i] == 0.0) {
      continue;
    }
    const double precision = half.col(i).squaredNorm();
    const double mean = values_[i] - weights_[i] / precision;
    result.push_back({offset_ + scale_ * mean, squared(scale_) / precision});
  }
  return result;
}

double GaussianProcess::leave_one_out_q2() const {
  double errors = 0.0;
  const std::vector<Posterior> expected = leave_one_out();
  const VectorXd values = values_alone(values_);
  for (Index i = 0; i < values.size(); ++i) {
    const double value = offset_ + scale_ * values[i];
    errors += squared(value - expected[static_cast<std::size_t>(i)].mean);
  }
  const double deviations = squared(scale_) * (values.array() - values.mean()).square().sum();
  const double tiny = 1e-20 * squared(scale_);
  return deviations > tiny ? 1.0 - errors / deviations : 0.0;
}

double GaussianProcess::noise() const {
  return scale_ * std::sqrt(noise_variance(encoding_, parameters_));
}

}  // namespace glint
