// SPDX-License-Identifier: GPL-3.0-or-later
//
// Detectability d' of a known signal in a correlated background, d'^2 = s^T K^-1 s. The covariance
// K is estimated from windows of the background and shrunk towards its diagonal (Schaefer and
// Strimmer 2005), so that it can be inverted from fewer windows than pixels; the inverse of an
// estimate is too large on average, which a factor, found by iteration, takes off (own derivation).
// docs/theory/statistics.md. Cost: about n p^2 + 10 p^3 operations for n windows of p pixels;
// memory some p^2.
#include "metrics/statistics/matched_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "core/error.h"

namespace glint {
namespace {

/// Windows as rows, each pixel with mean 0 and variance 1.
struct Standardised {
  Eigen::MatrixXd windows;
  Eigen::VectorXd deviations;  ///< standard deviation of each pixel
};

Standardised standardised(std::span<const std::vector<double>> background, Eigen::Index pixels) {
  const auto count = static_cast<Eigen::Index>(background.size());
  Standardised result = {.windows = Eigen::MatrixXd(count, pixels)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::vector<double>& window = background[static_cast<std::size_t>(k)];
    GLINT_CHECK(static_cast<Eigen::Index>(window.size()) == pixels,
                "windows have as many pixels as the signal");
    result.windows.row(k) = Eigen::Map<const Eigen::RowVectorXd>(window.data(), pixels);
  }
  const Eigen::RowVectorXd mean = result.windows.colwise().mean();
  result.windows.rowwise() -= mean;
  const double freedom = static_cast<double>(count - 1);
  Eigen::VectorXd variances = (result.windows.colwise().squaredNorm() / freedom).transpose();
  constexpr double kSmallestShare = 1e-9;  // a pixel that never varies is no perfect detector
  variances = variances.cwiseMax(kSmallestShare * variances.mean());
  result.deviations = variances.cwiseSqrt();
  if (variances.mean() > 0.0) {
    result.windows = result.windows * result.deviations.cwiseInverse().asDiagonal();
  }
  return result;
}

/// How far correlations are drawn to 0: the variance of all their estimates over their squares.
double shrinkage(const Eigen::MatrixXd& windows, const Eigen::MatrixXd& correlation) {
  const auto n = static_cast<double>(windows.rows());
  const Eigen::MatrixXd squares = windows.cwiseProduct(windows);
  const Eigen::MatrixXd of_products = squares.transpose() * squares;
  const Eigen::MatrixXd mean_products = correlation * ((n - 1.0) / n);
  const Eigen::MatrixXd variances =
      (of_products - n * mean_products.cwiseProduct(mean_products)) * (n / std::pow(n - 1.0, 3));
  const double uncertain = variances.sum() - variances.trace();
  const Eigen::MatrixXd sizes = correlation.cwiseProduct(correlation);
  const double all = sizes.sum() - sizes.trace();
  return all > 0.0 ? std::clamp(uncertain / all, 0.0, 1.0) : 1.0;
}

/// What the inverse of an estimated covariance is too large by, as a factor to its estimated part.
/// (1 - s) of the covariance is estimated: with eigenvalues l it behaves like m times the truth,
/// m = (n - 2 - sum (1 - s) l / ((1 - s) l + m s)) / (n - 1); (n - p - 2) / (n - 1) for s = 0.
double deflation(const Eigen::VectorXd& eigenvalues, double shrunk, double count) {
  const double minimum = 1.0 / count;
  double factor = 1.0;
  for (int i = 0; i < 100; ++i) {
    double used = 0.0;
    for (const double value : eigenvalues) {
      const double kept = (1.0 - shrunk) * std::max(value, 0.0);
      const double whole = kept + factor * shrunk;
      used += whole > 0.0 ? kept / whole : 0.0;
    }
    factor = 0.5 * (factor + std::max(minimum, (count - 2.0 - used) / (count - 1.0)));
  }
  return factor;
}

}  // namespace

double dprime(std::span<const double> signal, std::span<const std::vector<double>> background) {
  GLINT_CHECK(!signal.empty() && background.size() >= 2, "a signal and two windows are needed");
  const auto pixels = static_cast<Eigen::Index>(signal.size());
  const Eigen::Map<const Eigen::VectorXd> shape(signal.data(), pixels);
  if (shape.squaredNorm() == 0.0) {
    return 0.0;
  }
  const Standardised data = standardised(background, pixels);
  if (!(data.deviations.maxCoeff() > 0.0)) {
    return std::numeric_limits<double>::infinity();
  }
  const auto count = static_cast<double>(background.size());
  const Eigen::MatrixXd correlation = data.windows.transpose() * data.windows / (count - 1.0);
  const double shrunk = shrinkage(data.windows, correlation);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(correlation);
  const double factor = deflation(axes.eigenvalues(), shrunk, count);
  const Eigen::VectorXd seen =
      axes.eigenvectors().transpose() * shape.cwiseQuotient(data.deviations);
  constexpr double kSmallest = 1e-12;
  double squared = 0.0;
  for (Eigen::Index i = 0; i < pixels; ++i) {
    const double kept = (1.0 - shrunk) * std::max(axes.eigenvalues()[i], 0.0) / factor;
    squared += seen[i] * seen[i] / std::max(kept + shrunk, kSmallest);
  }
  return std::sqrt(squared);
}

}  // namespace glint
