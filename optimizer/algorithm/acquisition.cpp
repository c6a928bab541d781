// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/acquisition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace glint {

namespace {

using Eigen::Index;

constexpr int kNumDraws = 48;
/// Part of the plain sum in the Chebyshev sum.
constexpr double kAugmentation = 0.05;
/// Below this the logarithms follow their asymptotic series.
constexpr double kFarTail = -6.0;
/// An improvement (of objectives on one scale) that no draw showed.
constexpr double kNoImprovement = 1e-12;

double log_normal_density(double z) {
  return -0.5 * z * z - 0.5 * std::log(2.0 * std::numbers::pi);
}

}  // namespace

double log_normal_probability(double z) {
  if (z < kFarTail) {
    const double w = 1.0 / (z * z);
    return log_normal_density(z) - std::log(-z) + std::log1p(-w + 3.0 * w * w);
  }
  return std::log(0.5 * std::erfc(-z / std::numbers::sqrt2));
}

double log_expected_improvement(double best, double mean, double sigma) {
  const double z = (best - mean) / sigma;
  if (z < kFarTail) {
    const double w = 1.0 / (z * z);
    return std::log(sigma) + log_normal_density(z) + std::log(w) + std::log1p(-3.0 * w);
  }
  const double density = std::exp(log_normal_density(z));
  const double h = z * 0.5 * std::erfc(-z / std::numbers::sqrt2) + density;
  return std::log(sigma) + std::log(std::max(h, 1e-300));
}

Acquisition::Acquisition(std::span<const GaussianProcess> models,
                         int num_objectives,
                         std::vector<double> low,
                         std::vector<double> high,
                         Rng& rng)
    : models_(models),
      num_objectives_(static_cast<std::size_t>(num_objectives)),
      low_(std::move(low)),
      high_(std::move(high)) {
  double sum = 0.0;
  for (std::size_t i = 0; i < num_objectives_; ++i) {
    weights_.push_back(-std::log1p(-rng.uniform()) + 1e-12);
    sum += weights_.back();
  }
  for (double& weight : weights_) {
    weight /= sum;
  }
  if (num_objectives_ > 1) {
    normals_.resize(kNumDraws, num_objectives);
    for (double& value : normals_.reshaped()) {
      value = rng.normal();
    }
  }
  find_best(models_.front().num_points());
}

double Acquisition::combined(std::span<const double> objectives) const {
  if (num_objectives_ == 1) {
    return objectives[0];
  }
  double largest = -std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t i = 0; i < num_objectives_; ++i) {
    const double range = std::max(high_[i] - low_[i], 1e-12);
    const double part = weights_[i] * (objectives[i] - low_[i]) / range;
    largest = std::max(largest, part);
    sum += part;
  }
  return largest + kAugmentation * sum;
}

/// The best that is expected to keep all limits; else the one that is expected to miss them least.
void Acquisition::find_best(Index num_points) {
  std::vector<Eigen::VectorXd> means;
  for (const GaussianProcess& model : models_) {
    means.push_back(model.means_at_points());
  }
  double min_excess = std::numeric_limits<double>::infinity();
  best_ = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < num_points; ++i) {
    double excess = 0.0;
    for (std::size_t k = num_objectives_; k < models_.size(); ++k) {
      excess += means[k].size() == num_points ? std::max(0.0, means[k][i]) : 0.0;
    }
    std::vector<double> objectives;
    for (std::size_t k = 0; k < num_objectives_; ++k) {
      objectives.push_back(means[k][i]);
    }
    const double value = combined(objectives);
    if (excess < min_excess || (excess <= min_excess && value < best_)) {
      min_excess = excess;
      best_ = value;
      best_point_ = i;
    }
  }
  has_feasible_ = min_excess <= 0.0;
}

void Acquisition::add_improvement(const Eigen::MatrixXd& rows, Eigen::VectorXd& scores) const {
  std::vector<Eigen::MatrixX2d> expected;
  for (std::size_t k = 0; k < num_objectives_; ++k) {
    expected.push_back(models_[k].predict_rows(rows));
    expected.back().col(1) = expected.back().col(1).cwiseSqrt();
  }
  std::vector<double> objectives(num_objectives_);
  for (Index i = 0; i < rows.rows(); ++i) {
    if (num_objectives_ == 1) {
      scores[i] += log_expected_improvement(best_, expected[0](i, 0), expected[0](i, 1));
      continue;
    }
    double sum = 0.0;
    double mean = 0.0;
    for (Index draw = 0; draw < normals_.rows(); ++draw) {
      for (std::size_t k = 0; k < num_objectives_; ++k) {
        const auto column = static_cast<Index>(k);
        objectives[k] = expected[k](i, 0) + expected[k](i, 1) * normals_(draw, column);
      }
      const double value = combined(objectives);
      sum += std::max(0.0, best_ - value);
      mean += value / static_cast<double>(normals_.rows());
    }
    const double gain = sum / static_cast<double>(normals_.rows());
    scores[i] += gain > kNoImprovement ? std::log(gain)
                                       : std::log(kNoImprovement) - std::max(0.0, mean - best_);
  }
}

Eigen::VectorXd Acquisition::scores(const Eigen::MatrixXd& rows) const {
  Eigen::VectorXd scores = Eigen::VectorXd::Zero(rows.rows());
  for (std::size_t k = num_objectives_; k < models_.size(); ++k) {
    const Eigen::MatrixX2d expected = models_[k].predict_rows(rows);
    for (Index i = 0; i < rows.rows(); ++i) {
      scores[i] += log_normal_probability(-expected(i, 0) / std::sqrt(expected(i, 1)));
    }
  }
  if (has_feasible_) {
    add_improvement(rows, scores);
  }
  return scores;
}

}  // namespace glint
