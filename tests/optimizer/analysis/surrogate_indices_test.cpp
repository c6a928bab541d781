// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/analysis/surrogate_indices.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "core/error.h"
#include "core/rng.h"
#include "optimizer/algorithm/sobol.h"

namespace glint {
namespace {

SearchSpace cube(int dimension) {
  SearchSpace space;
  for (int i = 0; i < dimension; ++i) {
    space.variables.push_back({.name = "x" + std::to_string(i)});
  }
  return space;
}

std::vector<Point> design(int dimension, int count, std::uint64_t seed) {
  const Sobol sequence(seed, dimension);
  std::vector<Point> points;
  for (int k = 0; k < count; ++k) {
    points.push_back(sequence.point(static_cast<std::uint32_t>(k)));
  }
  return points;
}

Point same(std::span<const double> unit) {
  return {unit.begin(), unit.end()};
}

// y = 3 x0 + 2 x1 + 0 x2: variances 9 : 4 : 0, so shares 9/13, 4/13 and nothing.
TEST(SurrogateIndices, OfAPlaneWithADeadVariable) {
  const std::vector<Point> points = design(3, 40, 1);
  std::vector<double> values;
  for (std::size_t k = 0; k < points.size(); ++k) {
    Rng noise(7, Stream::kTest, k);
    values.push_back(3.0 * points[k][0] + 2.0 * points[k][1] + 0.05 * noise.normal());
  }
  GaussianProcess model(cube(3));
  model.fit(points, values);
  const auto indices = surrogate_indices(model, same, 3);
  EXPECT_NEAR(indices[0].first.value, 9.0 / 13.0, 0.04);
  EXPECT_NEAR(indices[1].total.value, 4.0 / 13.0, 0.04);
  EXPECT_LT(indices[2].total.value, 0.01);
  EXPECT_LE(indices[0].first.low, 9.0 / 13.0);
  EXPECT_GE(indices[0].first.high, 9.0 / 13.0);
  EXPECT_GT(indices[0].first.high - indices[0].first.low, 0.01);
}

TEST(SurrogateIndices, AreWiderWhereLessIsKnown) {
  const auto width = [](int count) {
    const std::vector<Point> points = design(2, count, 3);
    std::vector<double> values;
    for (const Point& point : points) {
      values.push_back(std::sin(7.0 * point[0]) + point[0] * point[1]);
    }
    GaussianProcess model(cube(2));
    model.fit(points, values);
    const VarianceShare share = surrogate_indices(model, same, 2)[1].total;
    return share.high - share.low;
  };
  EXPECT_GT(width(10), 2.0 * width(60));
}

TEST(SurrogateIndices, OfAConstantAreZero) {
  GaussianProcess model(cube(2));
  model.fit(design(2, 8, 1), std::vector<double>(8, 4.0));
  for (const SobolIndex& index : surrogate_indices(model, same, 2)) {
    EXPECT_EQ(index.total.high, 0.0);
  }
  EXPECT_THROW(surrogate_indices(model, same, 2, {.draws = 1}), ConfigError);
}

/// Shares of total indices that the intervals hold, over functions drawn from the model itself:
/// their truth is known from a dense design of the same draw.
TEST(SurrogateIndices, HoldTheTruthAsOftenAsTheySay) {
  constexpr int kCases = 40;
  const std::vector<Point> points = design(2, 24, 5);
  int held = 0;
  for (int k = 0; k < kCases; ++k) {
    GaussianProcess prior(cube(2));
    KernelParameters parameters(4);
    parameters << std::log(0.4), std::log(0.8), 0.0, std::log(1e-4);
    prior.set(parameters, std::vector<Point>{{0.5, 0.5}}, std::vector<double>{0.0});
    // One joint draw at the model's points and at those of the truth's design.
    std::vector<Point> all = points;
    const SobolSettings dense = {.samples = 128, .resamples = 2};
    double count = 0.0;
    sobol_indices(
        [&](std::span<const double> unit) {
          all.push_back(same(unit));
          return count += 1.0;
        },
        2,
        dense);
    const JointPosterior joint = prior.predict_jointly(all);
    Eigen::MatrixXd covariance = joint.covariance;
    covariance.diagonal().array() += 1e-8;
    Rng rng(11, Stream::kTest, static_cast<std::uint64_t>(k));
    Eigen::VectorXd normal(covariance.rows());
    for (double& value : normal) {
      value = rng.normal();
    }
    const Eigen::VectorXd drawn = covariance.llt().matrixL() * normal;
    Eigen::Index next = 24;
    const auto truth =
        sobol_indices([&](std::span<const double>) { return drawn[next++]; }, 2, dense);
    GaussianProcess model(cube(2));
    model.set(parameters, points, std::span<const double>(drawn.data(), 24));
    const VarianceShare found = surrogate_indices(model, same, 2, {.max_points = 512})[0].total;
    held += truth[0].total.value >= found.low - 0.01 && truth[0].total.value <= found.high + 0.01;
  }
  EXPECT_GE(held, 34);  // 95 % of 40 is 38; below 34 by chance in 1.4 %
}

}  // namespace
}  // namespace glint
