// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/fit/edge_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "core/median.h"

namespace glint::compare_detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPrice = 14.0;  ///< of a parameter, in squared standard deviations
/// What a parameter must explain of the misfit: the model of edges is not better than that where
/// they have moved far.
constexpr double kMinSquares = 0.001;
constexpr double kOutlierSigmas = 4.0;
constexpr double kAgreeingPx = 2.0;
constexpr int kMaxLag = 40;     ///< of neighbours whose noise may be alike
constexpr Index kStretch = 25;  ///< edges whose noise is taken together

/// How many neighbours tell what one would: 1 + 2 sum of the autocorrelations, at least 1.
double alike_neighbours(const VectorXd& rest) {
  const double square = rest.squaredNorm();
  double sum = 1.0;
  for (int lag = 1; lag <= kMaxLag && square > 0.0; ++lag) {
    const Eigen::Index count = rest.size() - lag;
    const double correlation = rest.head(count).dot(rest.tail(count)) / square;
    if (correlation < 0.05) {
      break;
    }
    sum += 2.0 * correlation;
  }
  return sum;
}

double median_size(const VectorXd& values) {
  std::vector<double> sizes;
  for (const double value : values) {
    sizes.push_back(std::abs(value));
  }
  return median(std::move(sizes));
}

}  // namespace

EdgeSystem::EdgeSystem(MatrixXd columns, VectorXd offsets_px, std::size_t parameters)
    : parameters_(parameters), columns_(std::move(columns)), offsets_(std::move(offsets_px)) {
  // Every column counts alike: parameters differ by many orders of magnitude.
  scales_ = columns_.colwise().norm().transpose().cwiseMax(1e-12);
  columns_.array().rowwise() /= scales_.transpose().array();
  leave_out_outliers();
}

VectorXd EdgeSystem::rest_of_all() const {
  const MatrixXd columns = columns_.leftCols(static_cast<Index>(parameters_));
  const MatrixXd weighted = weights_.asDiagonal() * columns;
  MatrixXd normal = weighted.transpose() * columns;
  normal.diagonal().array() += 1e-9 * normal.diagonal().maxCoeff();
  return offsets_ - columns * normal.ldlt().solve(weighted.transpose() * offsets_);
}

void EdgeSystem::leave_out_outliers() {
  weights_ = VectorXd::Ones(offsets_.size());
  for (int pass = 0; pass < 4; ++pass) {
    const VectorXd rest = rest_of_all();
    const double most = kOutlierSigmas * std::max(1.4826 * median_size(rest), 1e-6);
    weights_ = (rest.array().abs() <= most).cast<double>();
  }
  kept_ = static_cast<std::size_t>(std::lround(weights_.sum()));
  agreeing_ = (rest_of_all().array().abs() <= kAgreeingPx).cast<double>().mean();
  weigh_by_scatter(rest_of_all());
  const VectorXd rest = rest_of_all().cwiseProduct(weights_.cwiseSqrt());
  noise_px_ = std::max(
      std::sqrt(rest.squaredNorm() /
                std::max(static_cast<double>(kept_) - static_cast<double>(parameters_), 1.0)),
      1e-6);
  alike_ = alike_neighbours(rest);
  const MatrixXd weighted = weights_.asDiagonal() * columns_;
  normal_ = weighted.transpose() * columns_;
  right_ = weighted.transpose() * offsets_;
  right_squares_ = offsets_.dot(weights_.cwiseProduct(offsets_));
}

void EdgeSystem::weigh_by_scatter(const VectorXd& rest_px) {
  constexpr double kPrior = 10.0;  ///< edges' worth of the scatter of all
  const double mean = rest_px.cwiseAbs2().dot(weights_) / std::max(weights_.sum(), 1.0);
  for (Index first = 0; first < rest_px.size(); first += kStretch) {
    const auto rows = Eigen::seqN(first, std::min(kStretch, rest_px.size() - first));
    const double sum = rest_px(rows).cwiseAbs2().dot(weights_(rows)) + kPrior * mean;
    weights_(rows) *= (weights_(rows).sum() + kPrior) / std::max(sum, 1e-12);
  }
  weights_ *= static_cast<double>(kept_) / std::max(weights_.sum(), 1e-12);
}

double EdgeSystem::rest_of(std::span<const std::size_t> chosen) const {
  if (chosen.empty()) {
    return right_squares_;
  }
  const auto [normal, right] = part_of(chosen);
  return std::max(right_squares_ - right.dot(normal.ldlt().solve(right)), 0.0);
}

std::pair<MatrixXd, VectorXd> EdgeSystem::part_of(std::span<const std::size_t> chosen) const {
  const std::vector<Index> at(chosen.begin(), chosen.end());
  MatrixXd normal = normal_(at, at);
  normal.diagonal().array() += 1e-10;
  return {std::move(normal), right_(at)};
}

VectorXd EdgeSystem::scales_of(std::span<const std::size_t> chosen) const {
  return scales_(std::vector<Index>(chosen.begin(), chosen.end()));
}

VectorXd EdgeSystem::values_of(std::span<const std::size_t> chosen) const {
  const auto [normal, right] = part_of(chosen);
  return normal.ldlt().solve(right).cwiseQuotient(scales_of(chosen));
}

bool EdgeSystem::are_separable(std::span<const std::size_t> chosen) const {
  const MatrixXd inverse = part_of(chosen).first.inverse();
  const VectorXd sigma = inverse.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (Index i = 0; i < inverse.rows(); ++i) {
    for (Index j = 0; j < i; ++j) {
      if (std::abs(inverse(i, j)) > kNotSeparable * sigma[i] * sigma[j]) {
        return false;
      }
    }
  }
  return true;
}

std::vector<std::size_t> EdgeSystem::best_set() const {
  const double price =
      std::max(kPrice * alike_ * noise_px_ * noise_px_, kMinSquares * right_squares_);
  std::vector<std::size_t> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (unsigned set = 0; set < (1U << parameters_); ++set) {
    std::vector<std::size_t> chosen;
    for (std::size_t k = 0; k < parameters_; ++k) {
      if ((set >> k & 1U) != 0) {
        chosen.push_back(k);
      }
    }
    const double cost = rest_of(chosen) + price * static_cast<double>(chosen.size());
    if (cost < best_cost && (chosen.size() < 2 || are_separable(chosen))) {
      best_cost = cost;
      best = chosen;
    }
  }
  return best;
}

double EdgeSystem::correlation(std::size_t one,
                               std::size_t other,
                               std::span<const std::size_t> beside) const {
  std::vector<std::size_t> set = {one, other};
  std::ranges::copy_if(
      beside, std::back_inserter(set), [&](std::size_t k) { return k != one && k != other; });
  const MatrixXd inverse = part_of(set).first.inverse();
  return inverse(0, 1) / std::sqrt(inverse(0, 0) * inverse(1, 1));
}

MatrixXd EdgeSystem::scatter_of(std::span<const std::size_t> chosen,
                                const VectorXd& rest_px) const {
  const std::vector<Index> at(chosen.begin(), chosen.end());
  const auto count = static_cast<Index>(at.size());
  MatrixXd scatter = MatrixXd::Zero(count, count);
  Index stretches = 0;
  for (Index first = 0; first < rest_px.size(); first += kStretch, ++stretches) {
    const auto rows = Eigen::seqN(first, std::min(kStretch, rest_px.size() - first));
    const VectorXd sum =
        columns_(rows, at).transpose() * rest_px(rows).cwiseProduct(weights_(rows));
    scatter += sum * sum.transpose();
  }
  return scatter * static_cast<double>(stretches) /
         static_cast<double>(std::max<Index>(stretches - count, 1));
}

VectorXd EdgeSystem::sigmas_of(std::span<const std::size_t> chosen, const VectorXd& rest_px) const {
  const MatrixXd inverse = part_of(chosen).first.inverse();
  const VectorXd alike = alike_ * noise_px_ * noise_px_ * inverse.diagonal();
  const VectorXd scattered = (inverse * scatter_of(chosen, rest_px) * inverse).diagonal();
  return alike.cwiseMax(scattered).cwiseSqrt().cwiseQuotient(scales_of(chosen));
}

}  // namespace glint::compare_detail
