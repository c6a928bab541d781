// SPDX-License-Identifier: GPL-3.0-or-later
//
// `auto` against random sampling, at the budget where local searches have hardly begun.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <tuple>

#include "optimizer/algorithm/algorithm.h"
#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

using Function = std::function<double(const Point&)>;

constexpr int kNumSeeds = 11;
constexpr double kTwoPi = 6.283185307179586;

/// The optimum lies at another place for each seed.
Point optimum(int num_dimensions, int seed) {
  Rng rng(static_cast<std::uint64_t>(seed), Stream::kTest, 1);
  Point point;
  for (int i = 0; i < num_dimensions; ++i) {
    point.push_back(rng.uniform(-0.7, 0.7));
  }
  return point;
}

/// Turns neighbouring coordinates by 30 degrees around the optimum.
Point turned(const Point& x, const Point& around) {
  Point z(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    z[i] = x[i] - around[i];
  }
  for (std::size_t i = 0; i + 1 < z.size(); ++i) {
    const double a = 0.8660254037844386 * z[i] - 0.5 * z[i + 1];
    z[i + 1] = 0.5 * z[i] + 0.8660254037844386 * z[i + 1];
    z[i] = a;
  }
  return z;
}

double sphere(const Point& z) {
  double sum = 0.0;
  for (const double v : z) {
    sum += v * v;
  }
  return sum;
}

double rosenbrock(const Point& z) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < z.size(); ++i) {
    const double a = 2.0 * z[i] + 1.0;
    const double b = 2.0 * z[i + 1] + 1.0;
    sum += 100.0 * (b - a * a) * (b - a * a) + (1.0 - a) * (1.0 - a);
  }
  sum += 4.0 * z.back() * z.back();  // (1 - a)^2 of the last one
  return std::log1p(sum);
}

double rastrigin(const Point& z) {
  double sum = 0.0;
  for (const double v : z) {
    sum += 9.0 * v * v + 2.0 * (1.0 - std::cos(kTwoPi * 3.0 * v));
  }
  return sum;
}

double kinks(const Point& z) {
  double worst = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    worst = std::max(worst, static_cast<double>(i + 1) * std::abs(z[i]));
  }
  return worst;
}

double best_after(const std::string& name, int num_dimensions, int seed, const Function& f) {
  const Point center = optimum(num_dimensions, seed);
  const auto algorithm =
      make_algorithm(test::box(num_dimensions, -1, 1),
                     {.algorithm = name, .seed = static_cast<std::uint64_t>(seed)},
                     {});
  std::set<Point> evaluated;
  double best = 1e300;
  for (int asks = 0; evaluated.size() < 100 && asks < 2000; ++asks) {
    const Point point = *algorithm->ask();
    evaluated.insert(point);
    const double value = f(turned(point, center));
    best = std::min(best, value);
    algorithm->tell(point, value, false);
  }
  return best;
}

double median_after(const std::string& name, int num_dimensions, const Function& f) {
  std::vector<double> values;
  for (int seed = 1; seed <= kNumSeeds; ++seed) {
    values.push_back(best_after(name, num_dimensions, seed, f));
  }
  std::ranges::sort(values);
  return values[kNumSeeds / 2];
}

TEST(AutoSearch, IsNeverWorseThanRandomAfterAHundredEvaluations) {
  const std::vector<std::pair<std::string, Function>> functions = {
      {"sphere", sphere}, {"rosenbrock", rosenbrock}, {"rastrigin", rastrigin}, {"kinks", kinks}};
  for (const auto& [name, function] : functions) {
    for (const int num_dimensions : {1, 2, 3, 6, 10, 16}) {
      const double found = median_after("auto", num_dimensions, function);
      const double random = median_after("random", num_dimensions, function);
      EXPECT_LE(found, random) << name << " in " << num_dimensions << " dimensions";
      RecordProperty(name + std::to_string(num_dimensions),
                     std::to_string(found) + " against " + std::to_string(random));
    }
  }
}

/// The true value at the best observed one of 100, of values with noise; medians of five seeds.
double noisy_median_after(const std::string& name, double noise, const Function& f) {
  constexpr int kNumVariables = 6;
  std::vector<double> values;
  for (int seed = 1; seed <= 5; ++seed) {
    const Point center = optimum(kNumVariables, seed);
    const auto algorithm = make_algorithm(
        test::box(kNumVariables, -1, 1),
        {.algorithm = name, .seed = static_cast<std::uint64_t>(seed), .is_noisy = true},
        {});
    Rng rng(static_cast<std::uint64_t>(seed), Stream::kTest, 2);
    double observed = 1e300;
    double found = 1e300;
    for (int i = 0; i < 100; ++i) {
      const Point point = *algorithm->ask();
      const double truth = f(turned(point, center));
      const double value = truth + noise * rng.normal();
      if (value < observed) {
        observed = value;
        found = truth;
      }
      algorithm->tell(point, value, false);
    }
    values.push_back(found);
  }
  std::ranges::sort(values);
  return values[2];
}

TEST(GaussianSearch, IsBetterThanRandomSamplingUnderNoise) {
  const std::vector<std::tuple<std::string, double, Function>> functions = {
      {"sphere", 0.05, sphere},
      {"rosenbrock", 0.1, rosenbrock},
      {"rastrigin", 0.5, rastrigin},
      {"kinks", 0.1, kinks}};
  for (const auto& [name, noise, function] : functions) {
    const double found = noisy_median_after("gp", noise, function);
    const double random = noisy_median_after("random", noise, function);
    EXPECT_LT(found, random) << name;
    RecordProperty(name,
                   std::to_string(found) + " against " + std::to_string(random) + ", cobyla " +
                       std::to_string(noisy_median_after("cobyla", noise, function)) +
                       ", direct_l " +
                       std::to_string(noisy_median_after("direct_l", noise, function)));
  }
}

TEST(AutoSearch, SolvesASmoothProblemInAHundredEvaluations) {
  EXPECT_LT(median_after("auto", 6, sphere), 1e-4);
}

TEST(AutoSearch, FindsTheBestCategoryAndItsContinuousOptimum) {
  std::vector<double> values;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto algorithm = make_algorithm(test::mixed_space(), {.seed = seed}, {});
    double best = 1e300;
    for (int i = 0; i < 600; ++i) {
      const Point point = *algorithm->ask();
      const double value = test::mixed_value(point);
      best = std::min(best, value);
      algorithm->tell(point, value, false);
    }
    values.push_back(best);
  }
  std::ranges::sort(values);
  // Optimum: shape "round", where knots is inactive at its middle 6: 0.1 * |6 - 4| = 0.2.
  EXPECT_LT(values[2], 0.21);
}

}  // namespace
}  // namespace glint
