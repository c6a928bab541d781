// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/promise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "optimizer/algorithm/proposal.h"
#include "optimizer/algorithm/sobol.h"
#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

/// Models of two bowls and of a limit that wants the first coordinate below 0.7.
struct Models {
  SearchSpace space = test::box(3, 0, 1);
  std::vector<Point> points;
  std::vector<GaussianProcess> models;

  explicit Models(std::size_t num_objectives, double limit = 0.7, double noise_share = 1.0) {
    const Sobol sobol(3, 3);
    for (std::uint32_t i = 0; i < 24; ++i) {
      points.push_back(point_from_unit(space, sobol.point(i)));
    }
    for (std::size_t k = 0; k <= num_objectives; ++k) {
      std::vector<double> values;
      for (const Point& p : points) {
        double bowl = 0.0;
        for (const double x : p) {
          bowl += std::pow(x - (k == 0 ? 0.2 : 0.8), 2);
        }
        const double noise = test::noise(static_cast<int>(100 * k + values.size()));
        values.push_back((k == num_objectives ? p[0] - limit : bowl) + noise_share * noise);
      }
      models.emplace_back(space, GaussianProcessSettings{.is_noisy = noise_share > 0.0});
      models.back().fit(points, values);
    }
  }

  const Encoding& encoding() const { return models.front().encoding(); }
};

void expect_true_derivatives(const Promise& promise, const Models& given) {
  const Eigen::MatrixXd rows =
      given.encoding().rows(std::vector<Point>{{0.31, 0.42, 0.63}, {0.72, 0.55, 0.18}});
  Eigen::MatrixXd derivatives;
  const Eigen::MatrixXd no_shifts(rows.rows(), 0);
  const Eigen::VectorXd scores = promise.scores(rows, no_shifts, derivatives);
  EXPECT_TRUE(scores.isApprox(promise.scores(rows), 1e-12));
  constexpr double kStep = 1e-5;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    for (Eigen::Index c = 0; c < derivatives.cols(); ++c) {
      Eigen::MatrixXd above = rows;
      Eigen::MatrixXd below = rows;
      above(i, c) += kStep;
      below(i, c) -= kStep;
      const double derivative =
          (promise.scores(above)[i] - promise.scores(below)[i]) / (2.0 * kStep);
      // Far tails follow series that are cut after a few terms.
      EXPECT_NEAR(derivatives(i, c), derivative, 0.01 * (1.0 + std::abs(derivative)));
    }
  }
}

TEST(Promise, ItsDerivativesAreThoseOfItsScores) {
  const Models one(1);
  expect_true_derivatives(Promise(one.models, {}), one);
  const Models two(2);
  expect_true_derivatives(Promise(two.models, {3.0, 3.0}), two);
  const Models hopeless(2, -1.0);  // no design keeps the limit: its probability counts alone
  expect_true_derivatives(Promise(hopeless.models, {3.0, 3.0}), hopeless);
}

TEST(Promise, KnowsTheExpectedFrontOfFeasibleDesigns) {
  const Models two(2, 0.7, 0.0);
  const Promise promise(two.models, {3.0, 3.0});
  EXPECT_GE(promise.best_points().size(), 3U);
  for (const std::size_t point : promise.best_points()) {
    EXPECT_LE(two.points[point][0], 0.7 + 1e-3);
  }
}

/// Far from every candidate that is drawn: only who climbs comes so near.
TEST(Propose, ClimbsToTheBestPlaceThatTheModelKnows) {
  const Models one(1, 0.7, 0.0);
  const Promise promise(one.models, {});
  Rng rng(1, Stream::kSearch, 1);
  const std::optional<Point> point = propose({.space = one.space,
                                              .promise = promise,
                                              .encoding = one.encoding(),
                                              .known = one.points,
                                              .asked = {}},
                                             Reach::kEverywhere,
                                             rng);
  ASSERT_TRUE(point.has_value());
  for (const double x : *point) {
    EXPECT_NEAR(x, 0.2, 0.03);
  }
}

}  // namespace
}  // namespace glint
