// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/promise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "optimizer/algorithm/acquisition.h"
#include "optimizer/front/front.h"

namespace glint {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows of the front that the gain is measured from, by the number of objectives: boxes grow as
/// its power less one.
constexpr std::array<std::size_t, 4> kMaxFront = {150, 150, 40, 14};
constexpr std::size_t kMaxFrontBeyond = 8;
/// Of the volume between ideal and reference; below it a gain counts as none.
constexpr double kNoGain = 1e-200;
/// Of a value that is known without error, as a part of it: a degenerate normal, so that an
/// improvement is what it is and a limit holds or not.
constexpr double kExactSigma = 1e-12;

std::size_t max_front(std::size_t num_objectives) {
  return num_objectives <= kMaxFront.size() ? kMaxFront[num_objectives - 1] : kMaxFrontBeyond;
}

/// Of log(E[max(0, best - f)]) and log P(f < 0), by mean and sigma of f.
struct Differentiable {
  double value = 0.0;
  double by_mean = 0.0;
  double by_sigma = 0.0;
};

double log_density(double z) {
  return -0.5 * z * z - 0.5 * std::log(2.0 * std::numbers::pi);
}

Differentiable log_improvement(double best, double mean, double sigma) {
  const double z = (best - mean) / sigma;
  const double value = log_expected_improvement(best, mean, sigma);
  return {value, -std::exp(log_normal_probability(z) - value), std::exp(log_density(z) - value)};
}

Differentiable log_chance(double mean, double sigma) {
  const double z = -mean / sigma;
  const double value = log_normal_probability(z);
  const double by_z = std::exp(log_density(z) - value);
  return {value, -by_z / sigma, -by_z * z / sigma};
}

/// By how much a point is expected to miss the limits, which follow the objectives.
double excess_of(const std::vector<VectorXd>& means,
                 std::size_t num_objectives,
                 std::size_t point) {
  double excess = 0.0;
  for (std::size_t k = num_objectives; k < means.size(); ++k) {
    if (means[k].size() == means[0].size()) {
      excess += std::max(0.0, means[k][static_cast<Index>(point)]);
    }
  }
  return excess;
}

/// The objectives of each point.
std::vector<std::vector<double>> rows_of(const std::vector<VectorXd>& means,
                                         std::size_t num_objectives,
                                         const std::vector<std::size_t>& points) {
  std::vector<std::vector<double>> rows;
  for (const std::size_t point : points) {
    std::vector<double> row;
    for (std::size_t k = 0; k < num_objectives; ++k) {
      row.push_back(means[k][static_cast<Index>(point)]);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

template <class T>
std::vector<T> at_indices(const std::vector<T>& all, const std::vector<std::size_t>& indices) {
  std::vector<T> some;
  for (const std::size_t index : indices) {
    some.push_back(all[index]);
  }
  return some;
}

}  // namespace

Promise::Promise(std::span<const GaussianProcess> models,
                 std::vector<double> reference,
                 std::vector<bool> is_exact)
    : models_(models),
      num_objectives_(std::max<std::size_t>(1, reference.size())),
      reference_(std::move(reference)) {
  std::vector<VectorXd> means;
  is_exact.resize(models_.size(), false);
  for (std::size_t k = 0; k < models_.size(); ++k) {
    means.push_back(is_exact[k] ? models_[k].values_at_points() : models_[k].means_at_points());
  }
  if (num_objectives_ > 1) {
    find_front(means);
  } else {
    find_best(means);
  }
}

/// Points that are expected to keep all limits; else the one that is expected to miss them least.
std::vector<std::size_t> Promise::expected_feasible(const std::vector<VectorXd>& means) const {
  const Index num_points = models_.front().num_points();
  VectorXd excess = VectorXd::Zero(num_points);
  for (std::size_t k = num_objectives_; k < models_.size(); ++k) {
    if (means[k].size() == num_points) {  // that of success knows failures, too
      excess += means[k].cwiseMax(0.0);
    }
  }
  std::vector<std::size_t> points;
  for (Index i = 0; i < num_points; ++i) {
    if (excess[i] <= 0.0) {
      points.push_back(static_cast<std::size_t>(i));
    }
  }
  if (points.empty()) {
    Index least = 0;
    excess.minCoeff(&least);
    points.push_back(static_cast<std::size_t>(least));
  }
  return points;
}

void Promise::find_best(const std::vector<VectorXd>& means) {
  std::vector<std::size_t> points = expected_feasible(means);
  const auto mean_of = [&](std::size_t point) { return means[0][static_cast<Index>(point)]; };
  has_feasible_ = excess_of(means, num_objectives_, points.front()) <= 0.0;
  std::ranges::stable_sort(points, {}, mean_of);
  best_ = mean_of(points.front());
  points.resize(std::min<std::size_t>(points.size(), 5));
  best_points_ = std::move(points);
}

void Promise::find_front(const std::vector<VectorXd>& means) {
  const std::vector<std::size_t> points = expected_feasible(means);
  has_feasible_ = excess_of(means, num_objectives_, points.front()) <= 0.0;
  const std::vector<std::vector<double>> rows = rows_of(means, num_objectives_, points);
  const std::vector<std::size_t> front = front_of(rows);
  std::vector<std::vector<double>> values = at_indices(rows, front);
  ideal_ = values.front();
  for (const std::vector<double>& row : values) {
    for (std::size_t k = 0; k < num_objectives_; ++k) {
      ideal_[k] = std::min(ideal_[k], row[k]);
    }
  }
  std::vector<double> scaled_reference;
  for (std::size_t k = 0; k < num_objectives_; ++k) {
    const double range = reference_[k] - ideal_[k];
    range_.push_back(range > 0.0 ? range : 1.0);
    scaled_reference.push_back(range / range_[k]);
  }
  for (std::vector<double>& row : values) {
    for (std::size_t k = 0; k < num_objectives_; ++k) {
      row[k] = (row[k] - ideal_[k]) / range_[k];
    }
  }
  const auto kept = at_indices(values, spread_rows(values, max_front(num_objectives_)));
  best_points_ = at_indices(points, front);
  gain_ = std::make_unique<ExpectedHypervolume>(kept, scaled_reference);
}

VectorXd Promise::scores(const MatrixXd& rows) const {
  return scores_knowing(rows, MatrixXd(rows.rows(), 0));
}

VectorXd Promise::scores_knowing(const MatrixXd& rows, const MatrixXd& exact) const {
  std::vector<Eigen::MatrixX2d> expected(models_.size());
  for (std::size_t k = has_feasible_ ? 0 : num_objectives_; k < models_.size(); ++k) {
    expected[k] = models_[k].predict_rows(rows);
    expected[k].col(1) = expected[k].col(1).cwiseSqrt();
    const auto column = static_cast<Index>(k);
    for (Index i = 0; i < rows.rows() && column < exact.cols(); ++i) {
      const double value = exact(i, column);
      if (std::isfinite(value)) {
        expected[k].row(i) << value, kExactSigma * (1.0 + std::abs(value));
      }
    }
  }
  return scores_of(expected);
}

/// @param expected  of each model: mean and sigma of each row
VectorXd Promise::scores_of(const std::vector<Eigen::MatrixX2d>& expected) const {
  VectorXd scores = VectorXd::Zero(expected.back().rows());
  for (std::size_t k = num_objectives_; k < models_.size(); ++k) {
    for (Index i = 0; i < scores.size(); ++i) {
      scores[i] += log_chance(expected[k](i, 0), expected[k](i, 1)).value;
    }
  }
  std::vector<double> means(num_objectives_);
  std::vector<double> sigmas(num_objectives_);
  for (Index i = 0; i < scores.size() && has_feasible_; ++i) {
    if (num_objectives_ == 1) {
      scores[i] += log_expected_improvement(best_, expected[0](i, 0), expected[0](i, 1));
      continue;
    }
    for (std::size_t k = 0; k < num_objectives_; ++k) {
      means[k] = (expected[k](i, 0) - ideal_[k]) / range_[k];
      sigmas[k] = expected[k](i, 1) / range_[k];
    }
    scores[i] += std::log(gain_->value(means, sigmas) + kNoGain);
  }
  return scores;
}

MatrixXd Promise::shifts(const MatrixXd& rows, const MatrixXd& exact) const {
  MatrixXd shifts = MatrixXd::Zero(exact.rows(), exact.cols());
  for (Index k = 0; k < exact.cols(); ++k) {
    if (exact.col(k).array().isNaN().all()) {
      continue;
    }
    const VectorXd means = models_[static_cast<std::size_t>(k)].predict_rows(rows).col(0);
    for (Index i = 0; i < exact.rows(); ++i) {
      shifts(i, k) = std::isfinite(exact(i, k)) ? exact(i, k) - means[i] : 0.0;
    }
  }
  return shifts;
}

VectorXd Promise::scores(const MatrixXd& rows,
                         const MatrixXd& shifts,
                         MatrixXd& derivatives) const {
  VectorXd scores = VectorXd::Zero(rows.rows());
  derivatives = MatrixXd::Zero(rows.rows(), rows.cols() - 1);
  std::vector<PosteriorWithDerivatives> expected;
  for (const GaussianProcess& model : models_) {
    expected.push_back(model.predict_with_derivatives(rows));
  }
  for (Index k = 0; k < shifts.cols(); ++k) {
    expected[static_cast<std::size_t>(k)].mean += shifts.col(k);
  }
  const auto add = [&](std::size_t k, Index i, double by_mean, double by_sigma) {
    const double sigma = std::sqrt(expected[k].variance[i]);
    derivatives.row(i) += by_mean * expected[k].mean_derivatives.row(i) +
                          0.5 * by_sigma / sigma * expected[k].variance_derivatives.row(i);
  };
  std::vector<double> means(num_objectives_);
  std::vector<double> sigmas(num_objectives_);
  for (Index i = 0; i < rows.rows(); ++i) {
    for (std::size_t k = num_objectives_; k < models_.size(); ++k) {
      const Differentiable chance =
          log_chance(expected[k].mean[i], std::sqrt(expected[k].variance[i]));
      scores[i] += chance.value;
      add(k, i, chance.by_mean, chance.by_sigma);
    }
    if (has_feasible_ && num_objectives_ == 1) {
      const Differentiable gain =
          log_improvement(best_, expected[0].mean[i], std::sqrt(expected[0].variance[i]));
      scores[i] += gain.value;
      add(0, i, gain.by_mean, gain.by_sigma);
    } else if (has_feasible_) {
      for (std::size_t k = 0; k < num_objectives_; ++k) {
        means[k] = (expected[k].mean[i] - ideal_[k]) / range_[k];
        sigmas[k] = std::sqrt(expected[k].variance[i]) / range_[k];
      }
      const ExpectedHypervolume::Gain gain = gain_->gain(means, sigmas);
      scores[i] += std::log(gain.value + kNoGain);
      for (std::size_t k = 0; k < num_objectives_; ++k) {
        const double factor = 1.0 / (range_[k] * (gain.value + kNoGain));
        add(k, i, factor * gain.by_mean[k], factor * gain.by_sigma[k]);
      }
    }
  }
  return scores;
}

}  // namespace glint
