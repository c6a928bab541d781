// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/analysis/surrogate_indices.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>

#include "core/error.h"
#include "core/rng.h"

namespace glint {
namespace {

/// The points that an analysis asks for, in its order.
std::vector<Point> asked_points(const CubeMap& point_at,
                                int dimension,
                                const SobolSettings& settings) {
  std::vector<Point> points;
  double count = 0.0;  // a constant would end the analysis early
  sobol_indices(
      [&](std::span<const double> unit) {
        points.push_back(point_at(unit));
        return count += 1.0;
      },
      dimension,
      settings);
  return points;
}

/// The analysis of values at the points that it asks for.
std::vector<SobolIndex> indices_of(const Eigen::VectorXd& values,
                                   int dimension,
                                   const SobolSettings& settings) {
  Eigen::Index next = 0;
  return sobol_indices(
      [&](std::span<const double>) { return values[next++]; }, dimension, settings);
}

/// L of covariance = L L^T, with as little added to the diagonal as it takes.
Eigen::MatrixXd factor_of(Eigen::MatrixXd covariance) {
  const double scale = std::max(covariance.diagonal().maxCoeff(), 1e-300);
  double jitter = 1e-10;
  while (jitter < 1.0) {
    covariance.diagonal().array() += jitter * scale;
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    if (factor.info() == Eigen::Success) {
      return factor.matrixL();
    }
    jitter *= 10.0;
  }
  return Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols());
}

/// By how much the indices of drawn functions differ from those of their mean.
struct Differences {
  std::vector<std::vector<double>> first;  ///< for each coordinate one per draw
  std::vector<std::vector<double>> total;
};

Differences drawn_differences(const GaussianProcess& model,
                              const CubeMap& point_at,
                              int dimension,
                              const SurrogateSettings& settings) {
  SobolSettings rows = settings.of_mean;
  rows.resamples = 2;
  rows.samples = 16;
  while (2 * rows.samples * (dimension + 2) <= settings.max_points) {
    rows.samples *= 2;
  }
  const JointPosterior joint = model.predict_jointly(asked_points(point_at, dimension, rows));
  const Eigen::MatrixXd factor = factor_of(joint.covariance);
  const std::vector<SobolIndex> of_mean = indices_of(joint.mean, dimension, rows);
  Differences differences;
  differences.first.resize(of_mean.size());
  differences.total.resize(of_mean.size());
  for (int draw = 0; draw < settings.draws; ++draw) {
    Rng rng(settings.of_mean.seed, Stream::kResampling, static_cast<std::uint64_t>(draw) + 1);
    Eigen::VectorXd normal(joint.mean.size());
    std::ranges::generate(normal, [&] { return rng.normal(); });
    const Eigen::VectorXd values = joint.mean + factor.triangularView<Eigen::Lower>() * normal;
    const std::vector<SobolIndex> indices = indices_of(values, dimension, rows);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      differences.first[i].push_back(indices[i].first.value - of_mean[i].first.value);
      differences.total[i].push_back(indices[i].total.value - of_mean[i].total.value);
    }
  }
  return differences;
}

/// Moves a share by the average difference and widens its interval by their spread.
VarianceShare joined(const VarianceShare& of_mean, std::vector<double> drawn, double coverage) {
  double average = 0.0;
  for (const double difference : drawn) {
    average += difference / static_cast<double>(drawn.size());
  }
  std::ranges::sort(drawn);
  const auto at = [&](double share) {
    const double rank = share * static_cast<double>(drawn.size() - 1);
    return drawn[static_cast<std::size_t>(std::lround(rank))];
  };
  const double tail = 0.5 * (1.0 - coverage);
  const double below = std::hypot(of_mean.value - of_mean.low, average - at(tail));
  const double above = std::hypot(of_mean.high - of_mean.value, at(1.0 - tail) - average);
  const auto share = [](double value) { return std::clamp(value, 0.0, 1.0); };
  const double value = of_mean.value + average;
  return {.value = share(value), .low = share(value - below), .high = share(value + above)};
}

}  // namespace

std::vector<SobolIndex> surrogate_indices(const GaussianProcess& model,
                                          const CubeMap& point_at,
                                          int dimension,
                                          const SurrogateSettings& settings) {
  if (settings.draws < 2 || !(settings.coverage > 0.0 && settings.coverage < 1.0)) {
    throw ConfigError("indices of a model need two draws and a coverage between 0 and 1");
  }
  SobolSettings of_mean = settings.of_mean;
  of_mean.coverage = settings.coverage;
  const std::vector<double> means = model.predict_means(asked_points(point_at, dimension, of_mean));
  const auto [low, high] = std::ranges::minmax(means);
  if (high - low <= 1e-9 * std::max(std::abs(low), std::abs(high))) {
    return std::vector<SobolIndex>(static_cast<std::size_t>(dimension));
  }
  std::vector<SobolIndex> indices = indices_of(
      Eigen::Map<const Eigen::VectorXd>(means.data(), static_cast<Eigen::Index>(means.size())),
      dimension,
      of_mean);
  Differences differences = drawn_differences(model, point_at, dimension, settings);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    indices[i].first = joined(indices[i].first, std::move(differences.first[i]), settings.coverage);
    indices[i].total = joined(indices[i].total, std::move(differences.total[i]), settings.coverage);
  }
  return indices;
}

}  // namespace glint
