// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives as observations: covariances against differences of the kernel of values, and what a
// process learns from them.
#include "optimizer/surrogate/observed_kernel.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "optimizer/surrogate/gaussian_process.h"
#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDifferenceStep = 1e-4;

/// Random points of a space, random parameters, and at each point its value and two derivatives.
struct Scene {
  explicit Scene(const SearchSpace& space, int count = 9) : encoding(space) {
    Rng rng(5, Stream::kTest, 31);
    std::vector<Point> drawn;
    for (int i = 0; i < count; ++i) {
      std::vector<double> unit(space.variables.size());
      for (double& u : unit) {
        u = rng.uniform();
      }
      drawn.push_back(point_from_unit(space, unit));
    }
    points = encoding.rows(drawn);
    parameters = VectorXd(num_parameters(encoding));
    for (double& parameter : parameters) {
      parameter = -0.5 + 0.8 * rng.uniform();
    }
    std::vector<Index> numbers;
    for (std::size_t c = 0; c < encoding.columns().size(); ++c) {
      if (encoding.columns()[c].choice < 0) {
        numbers.push_back(static_cast<Index>(c));
      }
    }
    for (Index i = 0; i < count; ++i) {
      seen.push_back({.point = i});
      const auto first = static_cast<std::size_t>(i) % numbers.size();
      seen.push_back({.point = i, .column = numbers[first]});
      seen.push_back({.point = i, .column = numbers[(first + 1) % numbers.size()]});
    }
  }

  Observed observed() const {
    return {.encoding = encoding, .parameters = parameters, .points = points, .seen = seen};
  }

  /// By central differences of the kernel of values.
  double by_differences(const Observation& a, const Observation& b) const {
    double sum = 0.0;
    for (const double up : {-1.0, 1.0}) {
      for (const double right : {-1.0, 1.0}) {
        MatrixXd x = points.row(a.point);
        MatrixXd y = points.row(b.point);
        double factor = 0.25;
        if (a.column != Observation::kValue) {
          x(0, a.column) += up * kDifferenceStep;
          factor *= 2.0 * up / (2.0 * kDifferenceStep);
        }
        if (b.column != Observation::kValue) {
          y(0, b.column) += right * kDifferenceStep;
          factor *= 2.0 * right / (2.0 * kDifferenceStep);
        }
        sum += factor * covariance(encoding, parameters, x, y)(0, 0);
      }
    }
    return sum;
  }

  Encoding encoding;
  KernelParameters parameters;
  MatrixXd points;
  std::vector<Observation> seen;
};

TEST(ObservedKernel, OfDerivativesIsTheDerivativeOfTheKernel) {
  for (const SearchSpace& space : {test::box(3, 0, 1), test::mixed_space()}) {
    const Scene scene(space);
    const MatrixXd k = observed_covariance(scene.observed());
    double largest = 0.0;
    for (std::size_t i = 0; i < scene.seen.size(); ++i) {
      for (std::size_t j = 0; j < scene.seen.size(); ++j) {
        // The kernel's third derivative jumps at distance 0: differences of a step err by the step.
        const bool is_same = scene.seen[i].point == scene.seen[j].point;
        const double expected = scene.by_differences(scene.seen[i], scene.seen[j]);
        EXPECT_NEAR(k(static_cast<Index>(i), static_cast<Index>(j)),
                    expected,
                    (is_same ? 20.0 * kDifferenceStep : 1e-5) * (1.0 + std::abs(expected)));
        largest = std::max(largest, is_same ? 0.0 : std::abs(expected));
      }
    }
    EXPECT_GT(largest, 0.1);
    EXPECT_TRUE(k.isApprox(k.transpose(), 1e-14));
    // Positive definite up to rounding, as a covariance is.
    EXPECT_GT(k.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-9);
  }
}

TEST(ObservedKernel, AtOneDistanceIsAsWorkedByHand) {
  // One variable, length 0.5, x = 0.2, y = 0.5: s = -0.6, a = 1.34164, exp(-a) = 0.261416;
  // F = 5/3 * 2.34164 * 0.261416 = 1.020239, G = 25/3 * 0.261416 = 2.178470.
  const Encoding encoding(test::box(1, 0, 1));
  KernelParameters parameters(3);
  parameters << std::log(0.5), 0.0, -10.0;
  const MatrixXd points = encoding.rows(std::vector<Point>{{0.2}, {0.5}});
  const std::vector<Observation> seen = {
      {.point = 0}, {.point = 0, .column = 0}, {.point = 1, .column = 0}};
  const MatrixXd k = observed_covariance(
      Observed{.encoding = encoding, .parameters = parameters, .points = points, .seen = seen});
  EXPECT_NEAR(k(0, 0), 1.0, 1e-12);
  EXPECT_NEAR(k(0, 1), 0.0, 1e-12);
  EXPECT_NEAR(k(1, 1), 5.0 / 3.0 / 0.25, 1e-12);
  EXPECT_NEAR(k(0, 2), 1.020239 * -0.6 / 0.5, 1e-5);
  EXPECT_NEAR(k(1, 2), (1.020239 - 2.178470 * 0.36) / 0.25, 1e-5);
}

TEST(ObservedKernel, WithOtherRowsAgreesWithItself) {
  for (const SearchSpace& space : {test::box(3, 0, 1), test::mixed_space()}) {
    const Scene scene(space);
    const MatrixXd k = observed_covariance(scene.observed());
    const MatrixXd with_rows = observed_covariance(scene.observed(), scene.points);
    for (std::size_t j = 0; j < scene.seen.size(); ++j) {
      const Observation& what = scene.seen[j];
      const VectorXd column =
          observed_covariance(scene.observed(), scene.points.row(what.point), what.column);
      EXPECT_TRUE(column.isApprox(k.col(static_cast<Index>(j)), 1e-12));
      if (what.column == Observation::kValue) {
        EXPECT_TRUE(with_rows.col(what.point).isApprox(column, 1e-12));
      }
    }
  }
}

TEST(ObservedKernel, ItsDerivativesAreThoseOfItsCovariances) {
  const Scene scene(test::mixed_space());
  MatrixXd rows = scene.points.topRows(2);
  rows.col(0).array() += 0.07;
  const auto count = static_cast<Index>(scene.seen.size());
  const MatrixXd weights = MatrixXd::NullaryExpr(count, 2, [](Index i, Index r) {
    return std::sin(1.0 + 3.0 * static_cast<double>(i) + static_cast<double>(r));
  });
  const MatrixXd derivatives = observed_derivatives(scene.observed(), rows, {weights}).front();
  for (Index r = 0; r < rows.rows(); ++r) {
    for (Index c = 0; c < derivatives.cols(); ++c) {
      double expected = 0.0;
      for (const double side : {-1.0, 1.0}) {
        MatrixXd moved = rows;
        moved(r, c) += side * kDifferenceStep;
        expected += side / (2.0 * kDifferenceStep) *
                    observed_covariance(scene.observed(), moved).col(r).dot(weights.col(r));
      }
      EXPECT_NEAR(derivatives(r, c), expected, 1e-5 * (1.0 + std::abs(expected)));
    }
  }
}

TEST(ObservedKernel, ItsDerivativesByTheParametersAreThoseOfItsCovariances) {
  for (const SearchSpace& space : {test::box(3, 0, 1), test::mixed_space()}) {
    Scene scene(space);
    const auto count = static_cast<Index>(scene.seen.size());
    MatrixXd b = MatrixXd::NullaryExpr(count, count, [](Index i, Index k) {
      return std::cos(1.0 + static_cast<double>(i * k) + static_cast<double>(i + k));
    });
    const VectorXd gradient = observed_half_trace(scene.observed(), b);
    const Index noise = scene.encoding.num_lengths() + 1;
    for (Index p = 0; p < gradient.size(); ++p) {
      double expected = 0.0;
      for (const double side : {-1.0, 1.0}) {
        Scene moved = scene;
        moved.parameters[p] += side * kDifferenceStep;
        expected += side / (2.0 * kDifferenceStep) * 0.5 *
                    (b.array() * observed_covariance(moved.observed()).array()).sum();
      }
      EXPECT_NEAR(gradient[p], p == noise ? 0.0 : expected, 1e-5 * (1.0 + std::abs(expected)));
    }
  }
}

double wave(const Point& p) {
  return std::sin(3.0 * p[0]) + p[0] * p[1];
}

UnitDerivatives derivatives_of_wave(const Point& p) {
  return {3.0 * std::cos(3.0 * p[0]) + p[1], p[0]};
}

struct Waves {
  explicit Waves(int count) {
    Rng rng(2, Stream::kTest, 8);
    for (int i = 0; i < count; ++i) {
      points.push_back({rng.uniform(), rng.uniform()});
      values.push_back(wave(points.back()));
      derivatives.push_back(derivatives_of_wave(points.back()));
    }
  }

  std::vector<Point> points;
  std::vector<double> values;
  std::vector<UnitDerivatives> derivatives;
};

double worst_error(const GaussianProcess& process) {
  double worst = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Point p = {0.1 + 0.08 * (i % 10), 0.1 + 0.08 * (i / 10.0)};
    worst = std::max(worst, std::abs(process.predict(p).mean - wave(p)));
  }
  return worst;
}

TEST(GaussianProcess, InterpolatesAKnownFunctionByItsDerivatives) {
  const Waves known(6);
  const SearchSpace space = test::box(2, 0, 1);
  GaussianProcess with(space, {.is_noisy = false, .takes_derivatives = true});
  with.fit(known.points, known.values, {}, known.derivatives);
  GaussianProcess without(space, {.is_noisy = false});
  without.fit(known.points, known.values);
  EXPECT_EQ(with.num_points(), 6);
  EXPECT_EQ(with.num_derivatives(), 12);
  EXPECT_LT(worst_error(with), 0.08);
  EXPECT_GT(worst_error(without), 2.0 * worst_error(with));
  const PosteriorWithDerivatives at =
      with.predict_with_derivatives(with.encoding().rows(std::span(known.points).first(3)));
  for (Index i = 0; i < 3; ++i) {
    for (Index c = 0; c < 2; ++c) {
      const double derivative =
          known.derivatives[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
      EXPECT_NEAR(at.mean_derivatives(i, c), derivative, 0.05);
    }
    EXPECT_NEAR(with.means_at_points()[i], known.values[static_cast<std::size_t>(i)], 0.01);
  }
}

TEST(GaussianProcess, AddingDerivativesOneByOneIsTheSameAsAllAtOnce) {
  const Waves known(8);
  const SearchSpace space = test::box(2, 0, 1);
  GaussianProcess grown(space, {.takes_derivatives = true});
  grown.fit(known.points, known.values, {}, known.derivatives);
  // The second half again, moved, at their own values: mean and spread stay the same to both when
  // the values are the same.
  Waves more = known;
  for (std::size_t i = 0; i < known.points.size(); ++i) {
    Point moved = known.points[i];
    moved[0] = 1.0 - moved[0];
    more.points.push_back(moved);
    more.values.push_back(known.values[i]);
    more.derivatives.push_back(i % 2 == 0 ? known.derivatives[i] : UnitDerivatives{});
    grown.add(moved, known.values[i], {}, more.derivatives.back());
  }
  GaussianProcess whole(space, {.takes_derivatives = true});
  whole.set(grown.parameters(), more.points, more.values, {}, more.derivatives);
  EXPECT_EQ(grown.num_derivatives(), whole.num_derivatives());
  for (const Point& p : {Point{0.3, 0.4}, Point{0.8, 0.1}}) {
    EXPECT_NEAR(grown.predict(p).mean, whole.predict(p).mean, 1e-6);
    EXPECT_NEAR(grown.predict(p).variance, whole.predict(p).variance, 1e-6);
  }
}

TEST(GaussianProcess, LetsGoOfADerivativeThatTheOthersContradict) {
  Waves known(12);
  const SearchSpace space = test::box(2, 0, 1);
  GaussianProcess process(space, {.is_noisy = false, .takes_derivatives = true});
  process.fit(known.points, known.values, {}, known.derivatives);
  const KernelParameters parameters = process.parameters();
  EXPECT_EQ(process.drop_contradicted_derivatives(5.0), 0);
  known.derivatives[4][0] = -known.derivatives[4][0] - 3.0;
  process.set(parameters, known.points, known.values, {}, known.derivatives);
  const double misled = worst_error(process);
  EXPECT_GE(process.drop_contradicted_derivatives(5.0), 1);
  EXPECT_LT(worst_error(process), 0.3 * misled);
}

TEST(GaussianProcess, TakesDerivativesOnlyWhereTheyAreKnown) {
  Waves known(6);
  for (UnitDerivatives& derivatives : known.derivatives) {
    derivatives[1] = std::nan("");
  }
  known.derivatives[2].clear();
  GaussianProcess process(test::box(2, 0, 1), {.takes_derivatives = true});
  process.fit(known.points, known.values, {}, known.derivatives);
  EXPECT_EQ(process.num_derivatives(), 5);
}

}  // namespace
}  // namespace glint
