// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/front/front.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rng.h"

namespace glint {
namespace {

using Rows = std::vector<std::vector<double>>;
using testing::ElementsAre;

Rows random_rows(std::size_t num_rows, std::size_t num_objectives, std::uint64_t index) {
  Rng rng(5, Stream::kTest, index);
  Rows rows(num_rows, std::vector<double>(num_objectives));
  for (std::vector<double>& row : rows) {
    for (double& value : row) {
      value = rng.uniform();
    }
  }
  return rows;
}

/// By inclusion and exclusion over all subsets: another way to the same volume.
double volume_by_subsets(const Rows& rows, const std::vector<double>& reference) {
  double sum = 0.0;
  for (unsigned subset = 1; subset < (1U << rows.size()); ++subset) {
    double volume = -1.0;
    std::vector<double> corner(reference.size(), -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if ((subset >> i & 1U) != 0U) {
        volume = -volume;
        for (std::size_t k = 0; k < corner.size(); ++k) {
          corner[k] = std::max(corner[k], rows[i][k]);
        }
      }
    }
    for (std::size_t k = 0; k < corner.size(); ++k) {
      volume *= std::max(0.0, reference[k] - corner[k]);
    }
    sum += volume;
  }
  return sum;
}

TEST(FrontOf, KeepsWhatNoOtherBeatsAndTheFirstOfEquals) {
  const double nan = std::nan("");
  const Rows rows = {{2, 2}, {1, 3}, {2, 2}, {3, 1}, {3, 3}, {nan, 0}, {1, 4}};
  EXPECT_THAT(front_of(rows), ElementsAre(0U, 1U, 3U));
  EXPECT_TRUE(front_of(Rows{}).empty());
}

TEST(Hypervolume, OfTwoStepsIsTheirUnion) {
  // 3 * 1 + 1 * 2 less the corner 1 * 1 that both hold: (3 - 0) * (3 - 2) + (3 - 2) * (2 - 1) = 4.
  const Rows rows = {{0, 2}, {2, 1}};
  EXPECT_DOUBLE_EQ(hypervolume(rows, std::vector<double>{3, 3}), 4.0);
  EXPECT_DOUBLE_EQ(hypervolume(Rows{}, std::vector<double>{3, 3}), 0.0);
}

TEST(Hypervolume, LeavesOutWhatTheReferenceBeats) {
  const Rows rows = {{0, 2}, {-5, 4}, {std::nan(""), 0}};
  EXPECT_DOUBLE_EQ(hypervolume(rows, std::vector<double>{3, 3}), 3.0);
}

TEST(Hypervolume, AgreesWithInclusionAndExclusion) {
  for (std::uint64_t index = 0; index < 1000; ++index) {
    const std::size_t num_objectives = 1 + index % 5;
    const Rows rows = random_rows(1 + index % 7, num_objectives, index);
    const std::vector<double> reference(num_objectives, 0.9);
    EXPECT_NEAR(hypervolume(rows, reference), volume_by_subsets(rows, reference), 1e-12);
  }
}

TEST(HypervolumeContributions, AreWhatIsLostWithoutARow) {
  for (std::uint64_t index = 0; index < 200; ++index) {
    const std::size_t num_objectives = 2 + index % 3;
    const Rows rows = random_rows(12, num_objectives, 5000 + index);
    const std::vector<double> reference(num_objectives, 0.9);
    const std::vector<double> contributions = hypervolume_contributions(rows, reference);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Rows others = rows;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      const double lost = hypervolume(rows, reference) - hypervolume(others, reference);
      EXPECT_NEAR(contributions[i], lost, 1e-12);
    }
  }
}

TEST(HypervolumeContributions, AreNothingForTwins) {
  const Rows rows = {{1, 1}, {1, 1}};
  EXPECT_THAT(hypervolume_contributions(rows, std::vector<double>{2, 2}), ElementsAre(0.0, 0.0));
}

}  // namespace
}  // namespace glint
