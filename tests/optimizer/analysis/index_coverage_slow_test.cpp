// SPDX-License-Identifier: GPL-3.0-or-later
//
// How often the intervals of Sobol indices hold the truth: of functions that are drawn from the
// model's own Gaussian process, and of functions that are of another kind (misspecified).
//
// The intervals of one function move together, so that the 720 of the first test tell about as much
// as 360 independent ones: a true coverage of 95 % is seen within 95 +- 1.2 points (one standard
// deviation), of which the bars lie four below and two and a half above.
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "optimizer/algorithm/sobol.h"
#include "optimizer/analysis/surrogate_indices.h"
#include "tests/optimizer/analysis/ishigami.h"

namespace glint {
namespace {

constexpr int kDimension = 3;
/// As in studies/analysis/evidence.h: below it no indices are shown.
constexpr double kShownQ2 = 0.7;
/// Truths that were estimated themselves.
constexpr double kSlack = 0.001;

using Function = std::function<double(std::span<const double> unit)>;

using TrueIndices = std::array<test::TrueIndex, kDimension>;

/// How many intervals there are and how many of them hold the truth.
struct Coverage {
  int intervals = 0;
  int held = 0;

  void look_at(const VarianceShare& found, double truth) {
    ++intervals;
    held += found.low - kSlack <= truth && truth <= found.high + kSlack ? 1 : 0;
  }

  void look_at(const std::vector<SobolIndex>& found, const TrueIndices& truth) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
      look_at(found[i].first, truth[i].first);
      look_at(found[i].total, truth[i].total);
    }
  }

  double share() const { return static_cast<double>(held) / intervals; }
};

SearchSpace unit_cube() {
  SearchSpace space;
  for (int i = 0; i < kDimension; ++i) {
    space.variables.push_back({.name = "x" + std::to_string(i)});
  }
  return space;
}

std::vector<Point> even_design(int count, std::uint64_t seed) {
  const Sobol sequence(seed, kDimension);
  std::vector<Point> points;
  for (int k = 0; k < count; ++k) {
    points.push_back(sequence.point(static_cast<std::uint32_t>(k)));
  }
  return points;
}

std::vector<double> values_of(const Function& function, const std::vector<Point>& points) {
  std::vector<double> values;
  for (const Point& point : points) {
    values.push_back(function(point));
  }
  return values;
}

/// Of a small design of 128 rows, which is enough here and quick.
std::vector<SobolIndex> found_indices(const GaussianProcess& model) {
  return surrogate_indices(
      model,
      [](std::span<const double> unit) { return Point(unit.begin(), unit.end()); },
      kDimension,
      {.max_points = 640});
}

/// A function drawn from a Gaussian process of variance 1 with the model's kernel, Matern 5/2: a
/// sum of waves whose frequencies have its spectrum, Student's distribution with 5 degrees of
/// freedom (A. Rahimi, B. Recht, "Random features for large-scale kernel machines", NIPS 2007).
class DrawnFunction {
 public:
  DrawnFunction(std::span<const double> lengths, std::uint64_t draw) {
    Rng rng(41, Stream::kTest, draw);
    for (Wave& wave : waves_) {
      double squares = 0.0;
      for (int k = 0; k < kDegrees; ++k) {
        const double normal = rng.normal();
        squares += normal * normal;
      }
      const double widened = std::sqrt(kDegrees / squares);
      for (std::size_t i = 0; i < wave.frequency.size(); ++i) {
        wave.frequency[i] = widened * rng.normal() / lengths[i];
      }
      wave.phase = 2.0 * std::numbers::pi * rng.uniform();
      wave.amplitude = std::sqrt(2.0 / kWaves) * rng.normal();
    }
  }

  double operator()(std::span<const double> unit) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) {
      double angle = wave.phase;
      for (std::size_t i = 0; i < wave.frequency.size(); ++i) {
        angle += wave.frequency[i] * unit[i];
      }
      sum += wave.amplitude * std::cos(angle);
    }
    return sum;
  }

 private:
  static constexpr int kDegrees = 5;
  static constexpr int kWaves = 300;

  struct Wave {
    std::array<double, kDimension> frequency = {};
    double phase = 0.0;
    double amplitude = 0.0;
  };

  std::array<Wave, kWaves> waves_;
};

TrueIndices estimated_truth(const Function& function) {
  const auto dense =
      sobol_indices(function, kDimension, {.samples = 2048, .resamples = 2, .seed = 99});
  TrueIndices truth;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    truth[i] = {.first = dense[i].first.value, .total = dense[i].total.value};
  }
  return truth;
}

/// A model that knows the parameters that the function was drawn by; without noise.
GaussianProcess knowing_model(std::span<const double> lengths,
                              const std::vector<Point>& points,
                              const std::vector<double>& values) {
  double mean = 0.0;
  for (const double value : values) {
    mean += value / static_cast<double>(values.size());
  }
  double variance = 0.0;  // the model's unit: parameters are of values with variance 1
  for (const double value : values) {
    variance += (value - mean) * (value - mean) / static_cast<double>(values.size());
  }
  KernelParameters parameters(kDimension + 2);
  for (int i = 0; i < kDimension; ++i) {
    parameters[i] = std::log(lengths[static_cast<std::size_t>(i)]);
  }
  parameters[kDimension] = -std::log(variance);
  parameters[kDimension + 1] = std::log(1e-4);
  GaussianProcess model(unit_cube());
  model.set(parameters, points, values);
  return model;
}

// Few designs leave wide intervals (0.31 on average), more of them narrower ones (0.23). Another
// program that computes the same, with other draws, has 95.6 % of 16 designs and 94.2 % of 24.
TEST(IndexCoverage, OfFunctionsFromTheModelIsAsStated) {
  constexpr std::array<double, kDimension> kLengths = {0.4, 0.6, 0.8};
  Coverage all;
  for (const int count : {16, 24}) {
    const std::vector<Point> points = even_design(count, 5);
    for (std::uint64_t draw = 0; draw < 60; ++draw) {
      const DrawnFunction function(kLengths, 100 * static_cast<std::uint64_t>(count) + draw);
      const GaussianProcess model = knowing_model(kLengths, points, values_of(function, points));
      all.look_at(found_indices(model), estimated_truth(function));
    }
  }
  EXPECT_EQ(all.intervals, 720);
  EXPECT_GE(all.share(), 0.90);
  EXPECT_LE(all.share(), 0.98);
}

/// Of a function whose true indices are known, where leave-one-out lets them be shown: with fitted
/// parameters, from 20 designs.
Coverage coverage_of(const Function& function, const TrueIndices& truth, int num_points) {
  Coverage coverage;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<Point> points = even_design(num_points, 50 + seed);
    GaussianProcess model(unit_cube());
    model.fit(points, values_of(function, points));
    if (model.leave_one_out_q2() >= kShownQ2) {
      coverage.look_at(found_indices(model), truth);
    }
  }
  return coverage;
}

// The model, which has no additive part, takes some of what the second coordinate does alone for
// interaction, so that most of what is not held are totals of it.
Coverage ishigami_coverage() {
  return coverage_of(test::ishigami, test::ishigami_indices(), 150);
}

// Sobol's g-function, product of (|4 x_i - 2| + a_i) / (1 + a_i), a = (0, 1, 4.5): kinks, which the
// kernel does not know. With v_i = 1 / (3 (1 + a_i)^2) and the variance V = prod(1 + v_i) - 1 the
// first-order index is v_i / V, the total v_i prod(1 + v_k, k other than i) / V.
Coverage g_function_coverage() {
  constexpr std::array<double, kDimension> kAs = {0.0, 1.0, 4.5};
  const auto function = [&](std::span<const double> unit) {
    double product = 1.0;
    for (std::size_t i = 0; i < kAs.size(); ++i) {
      product *= (std::abs(4.0 * unit[i] - 2.0) + kAs[i]) / (1.0 + kAs[i]);
    }
    return product;
  };
  double all = 1.0;
  for (const double a : kAs) {
    all *= 1.0 + 1.0 / (3.0 * (1.0 + a) * (1.0 + a));
  }
  TrueIndices truth;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double alone = 1.0 / (3.0 * (1.0 + kAs[i]) * (1.0 + kAs[i]));
    truth[i].first = alone / (all - 1.0);
    truth[i].total = alone * all / (1.0 + alone) / (all - 1.0);
  }
  return coverage_of(function, truth, 60);
}

// Another program that computes the same has 90 % of those shown of Ishigami's function (10 designs
// of 150 points, of which 8 are shown), and 96 % of the g-function (20 designs of 60 points).
TEST(IndexCoverage, OfOtherFunctionsIsAtLeastFourOfFive) {
  const Coverage ishigami = ishigami_coverage();
  const Coverage kinks = g_function_coverage();
  EXPECT_GE(ishigami.intervals, 60) << "designs of which indices are shown: half of them at least";
  EXPECT_GE(kinks.intervals, 60);
  EXPECT_GE(kinks.share(), 0.8);
  EXPECT_GE(
      static_cast<double>(ishigami.held + kinks.held) / (ishigami.intervals + kinks.intervals),
      0.8);
  EXPECT_GE(ishigami.share(), 0.7) << "the harder one by itself";
}

}  // namespace
}  // namespace glint
