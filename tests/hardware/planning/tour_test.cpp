// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/tour.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

Eigen::MatrixXd random_costs(std::uint64_t index, int count) {
  Rng rng(7, Stream::kTest, index);
  Eigen::MatrixXd places(2, count);
  for (double& value : places.reshaped()) {
    value = rng.uniform(0.0, 1.0);
  }
  Eigen::MatrixXd costs(count, count);
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) {
      costs(a, b) = (places.col(a) - places.col(b)).norm();
    }
  }
  return costs;
}

double shortest(const Eigen::MatrixXd& costs) {
  std::vector<std::size_t> order(static_cast<std::size_t>(costs.rows()) - 1);
  std::iota(order.begin(), order.end(), 1);
  double least = std::numeric_limits<double>::infinity();
  do {
    least = std::min(least, tour_cost(costs, order));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

TEST(ShortTour, IsNearlyAsShortAsTheShortest) {
  double sum = 0.0;
  constexpr int kTours = 50;
  for (std::uint64_t i = 0; i < kTours; ++i) {
    const Eigen::MatrixXd costs = random_costs(i, 8);
    const std::vector<std::size_t> order = short_tour(costs);
    std::vector<std::size_t> sorted = order;
    std::ranges::sort(sorted);
    for (std::size_t k = 0; k < sorted.size(); ++k) {
      ASSERT_EQ(sorted[k], k + 1) << "each stop once";
    }
    sum += tour_cost(costs, order) / shortest(costs);
  }
  EXPECT_LT(sum / kTours, 1.02);
  EXPECT_GE(sum / kTours, 1.0);
}

// A square with side 1, given so that the nearest neighbours come first: around it is 4.
TEST(ShortTour, GoesAroundASquare) {
  Eigen::MatrixXd costs(4, 4);
  const double d = std::sqrt(2.0);
  costs << 0, 1, d, 1, 1, 0, 1, d, d, 1, 0, 1, 1, d, 1, 0;
  EXPECT_DOUBLE_EQ(tour_cost(costs, short_tour(costs)), 4.0);
  EXPECT_TRUE(short_tour(Eigen::MatrixXd::Zero(1, 1)).empty());
}

TEST(CheapestChoices, AreThoseOfTryingAll) {
  const std::vector<std::size_t> counts = {2, 3, 1, 2};
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const auto cost = [seed](std::size_t i, std::size_t a, std::size_t b) {
      return Rng(seed, Stream::kTest, 100 * i + 10 * a + b).uniform(0.0, 1.0);
    };
    const auto sum_of = [&](const std::vector<std::size_t>& choices) {
      double sum = 0.0;
      for (std::size_t i = 0; i <= choices.size(); ++i) {
        sum += cost(i, i == 0 ? 0 : choices[i - 1], i == choices.size() ? 0 : choices[i]);
      }
      return sum;
    };
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 12; ++k) {
      least = std::min(least, sum_of({k % 2, (k / 2) % 3, 0, k / 6}));
    }
    ASSERT_NEAR(sum_of(cheapest_choices(counts, cost)), least, 1e-12);
  }
}

}  // namespace
}  // namespace glint
