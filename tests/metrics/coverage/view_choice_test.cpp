// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/coverage/view_choice.h"

#include <algorithm>
#include <bit>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Core>

#include "core/error.h"
#include "core/rng.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using ::testing::UnorderedElementsAre;

struct Problem {
  Visibility visibility;
  std::vector<double> weights;
};

/// Views of random density; points of random weight.
Problem random_problem(std::uint64_t number, std::size_t views, std::size_t points) {
  Rng rng(7, Stream::kTest, number);
  Problem problem = {.visibility = Visibility(views, points),
                     .weights = std::vector<double>(points)};
  const double density = 0.03 + 0.4 * rng.uniform();
  for (std::size_t i = 0; i < points; ++i) {
    problem.weights[i] = rng.uniform();
    for (std::size_t v = 0; v < views; ++v) {
      if (rng.uniform() < density) {
        problem.visibility.set(v, i);
      }
    }
  }
  return problem;
}

/// Views that see caps of a sphere, as views of a part do.
Problem caps(std::uint64_t number, std::size_t views, std::size_t points, double cosine) {
  Rng rng(11, Stream::kTest, number);
  const auto draw = [&] {
    const Eigen::Vector3d v(rng.normal(), rng.normal(), rng.normal());
    return Eigen::Vector3d(v.normalized());
  };
  Problem problem = {.visibility = Visibility(views, points),
                     .weights = std::vector<double>(points, 1.0)};
  std::vector<Eigen::Vector3d> places(points);
  std::ranges::generate(places, draw);
  for (std::size_t v = 0; v < views; ++v) {
    const Eigen::Vector3d axis = draw();
    for (std::size_t i = 0; i < points; ++i) {
      if (places[i].dot(axis) > cosine) {
        problem.visibility.set(v, i);
      }
    }
  }
  return problem;
}

double share_of(const Problem& problem, std::uint32_t views) {
  double seen = 0.0;
  double whole = 0.0;
  for (std::size_t i = 0; i < problem.weights.size(); ++i) {
    bool is_seen = false;
    for (std::size_t v = 0; v < problem.visibility.num_views(); ++v) {
      is_seen = is_seen || ((views >> v & 1U) != 0 && problem.visibility.sees(v, i));
    }
    seen += is_seen ? problem.weights[i] : 0.0;
    whole += problem.weights[i];
  }
  return seen / whole;
}

std::uint32_t bits_of(const std::vector<std::size_t>& views) {
  std::uint32_t bits = 0;
  for (const std::size_t view : views) {
    bits |= 1U << view;
  }
  return bits;
}

double best_by_trying_all(const Problem& problem, int count) {
  double best = 0.0;
  for (std::uint32_t views = 0; views < 1U << problem.visibility.num_views(); ++views) {
    if (std::popcount(views) == count) {
      best = std::max(best, share_of(problem, views));
    }
  }
  return best;
}

// Weights 3.5 4 4 3.5: the view of the two in the middle sees 8 and is greedy's first; with another
// 3.5 that makes 11.5. The other two views see 7.5 each and 15 together.
TEST(ChooseViews, ExactFindsWhatGreedyMisses) {
  const std::vector<double> weights = {3.5, 4.0, 4.0, 3.5};
  Visibility visibility(3, 4);
  visibility.set(0, 1);
  visibility.set(0, 2);
  visibility.set(1, 0);
  visibility.set(1, 1);
  visibility.set(2, 2);
  visibility.set(2, 3);
  const ViewChoice greedy = choose_greedy(visibility, weights, 2);
  EXPECT_THAT(greedy.views, ElementsAre(0U, 1U));
  EXPECT_NEAR(greedy.share, 11.5 / 15.0, 1e-15);
  const ViewChoice exact = choose_exact(visibility, weights, 2);
  EXPECT_THAT(exact.views, UnorderedElementsAre(1U, 2U));
  EXPECT_NEAR(exact.share, 1.0, 1e-15);
  EXPECT_TRUE(exact.is_proven);
}

TEST(ChooseViews, ExactEqualsTryingAllOnAllSmallCases) {
  std::uint64_t number = 0;
  for (std::size_t views = 1; views <= 10; ++views) {
    for (int count = 1; count <= static_cast<int>(views); ++count) {
      for (int trial = 0; trial < 20; ++trial) {
        const Problem problem = random_problem(++number, views, 40);
        const ViewChoice exact = choose_exact(problem.visibility, problem.weights, count);
        ASSERT_TRUE(exact.is_proven);
        ASSERT_EQ(exact.views.size(), static_cast<std::size_t>(count));
        ASSERT_NEAR(exact.share, best_by_trying_all(problem, count), 1e-11)
            << views << " views, " << count << " to choose, case " << number;
        ASSERT_NEAR(exact.share, share_of(problem, bits_of(exact.views)), 1e-11);
      }
    }
  }
}

TEST(ChooseViews, TwentyFiveViewsOfWhichSixAreSolvedExactly) {
  for (std::uint64_t number = 0; number < 6; ++number) {
    const Problem problem = caps(number, 25, 3000, 0.5 + 0.08 * static_cast<double>(number));
    const ViewChoice exact = choose_exact(problem.visibility, problem.weights, 6);
    EXPECT_TRUE(exact.is_proven) << exact.nodes << " nodes";
    const ViewChoice greedy = choose_greedy(problem.visibility, problem.weights, 6);
    EXPECT_GE(exact.share, greedy.share - 1e-12);
  }
}

TEST(ChooseViews, GreedysMedianIsAtLeastNinetyEightPerCentOfExact) {
  std::vector<double> ratios;
  for (std::uint64_t number = 0; number < 200; ++number) {
    const Problem problem =
        caps(1000 + number, 14, 300, 0.2 + 0.6 * static_cast<double>(number) / 200);
    const int count = 2 + static_cast<int>(number % 5);
    ratios.push_back(choose_greedy(problem.visibility, problem.weights, count).share /
                     choose_exact(problem.visibility, problem.weights, count).share);
  }
  std::ranges::sort(ratios);
  EXPECT_GE(ratios[ratios.size() / 2], 0.98);
  EXPECT_GE(ratios.front(), 1.0 - 1.0 / 2.71828182845904);  // proven for any case
  EXPECT_LT(ratios.front(), 1.0 - 1e-9);                    // else the cases would tell nothing
}

TEST(ChooseViews, MoreThanThereAreTakesAll) {
  const Problem problem = random_problem(3, 4, 50);
  const ViewChoice exact = choose_exact(problem.visibility, problem.weights, 9);
  EXPECT_EQ(exact.views.size(), 4U);
  EXPECT_TRUE(exact.is_proven);
  EXPECT_EQ(choose_greedy(problem.visibility, problem.weights, 9).views, exact.views);
}

TEST(ChooseViews, ACutOffSearchIsNotProven) {
  const Problem problem = caps(5, 20, 500, 0.7);
  const ViewChoice cut = choose_exact(problem.visibility, problem.weights, 6, 2);
  EXPECT_FALSE(cut.is_proven);
  EXPECT_EQ(cut.views.size(), 6U);
  EXPECT_GE(cut.share, choose_greedy(problem.visibility, problem.weights, 6).share - 1e-12);
}

TEST(ChooseViews, RefusesToChooseNone) {
  const Problem problem = random_problem(4, 3, 10);
  EXPECT_THAT([&] { choose_greedy(problem.visibility, problem.weights, 0); },
              ThrowsMessage<ConfigError>(HasSubstr("must be at least 1")));
  EXPECT_THAT([&] { choose_exact(problem.visibility, problem.weights, -2); },
              ThrowsMessage<ConfigError>(HasSubstr("-2 views")));
}

}  // namespace
}  // namespace glint
