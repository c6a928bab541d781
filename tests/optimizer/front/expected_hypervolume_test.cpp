// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/front/expected_hypervolume.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/rng.h"
#include "optimizer/front/front.h"

namespace glint {
namespace {

using Row = std::vector<double>;

/// Random rows near the simplex, of which most are on the front.
std::vector<Row> some_front(std::size_t num_objectives, int count, Rng& rng) {
  std::vector<Row> rows;
  for (int i = 0; i < count; ++i) {
    Row row;
    double sum = 0.0;
    for (std::size_t k = 0; k < num_objectives; ++k) {
      row.push_back(-std::log1p(-rng.uniform()));
      sum += row.back();
    }
    for (double& value : row) {
      value = value / sum + 0.05 * rng.uniform();
    }
    rows.push_back(row);
  }
  return rows;
}

Row some_row(std::size_t num_objectives, Rng& rng) {
  Row row;
  for (std::size_t k = 0; k < num_objectives; ++k) {
    row.push_back(rng.uniform(-0.2, 1.2));
  }
  return row;
}

double gained(std::vector<Row> front, const Row& row, const Row& reference) {
  const double before = hypervolume(front, reference);
  front.push_back(row);
  return hypervolume(front, reference) - before;
}

TEST(ExpectedHypervolume, OfACertainDesignIsWhatItAdds) {
  for (const std::size_t m : {1U, 2U, 3U, 4U}) {
    Rng rng(5, Stream::kTest, m);
    const std::vector<Row> front = some_front(m, 12, rng);
    const Row reference(m, 1.1);
    const ExpectedHypervolume expected(front, reference);
    for (int i = 0; i < 40; ++i) {
      const Row row = some_row(m, rng);
      const Row sigmas(m, 1e-9);
      EXPECT_NEAR(expected.value(row, sigmas), gained(front, row, reference), 1e-7) << m;
    }
  }
}

TEST(ExpectedHypervolume, OfAnUncertainDesignIsTheMeanOverItsDraws) {
  for (const std::size_t m : {2U, 3U}) {
    Rng rng(6, Stream::kTest, m);
    const std::vector<Row> front = some_front(m, 8, rng);
    const Row reference(m, 1.1);
    const ExpectedHypervolume expected(front, reference);
    const Row means(m, 0.4);
    const Row sigmas = {0.2, 0.1, 0.3};
    constexpr int kNumDraws = 20000;
    double sum = 0.0;
    double sum_of_squares = 0.0;
    for (int i = 0; i < kNumDraws; ++i) {
      Row row;
      for (std::size_t k = 0; k < m; ++k) {
        row.push_back(means[k] + sigmas[k] * rng.normal());
      }
      const double gain = gained(front, row, reference);
      sum += gain;
      sum_of_squares += gain * gain;
    }
    const double mean = sum / kNumDraws;
    const double error = std::sqrt((sum_of_squares / kNumDraws - mean * mean) / kNumDraws);
    EXPECT_NEAR(expected.value(means, std::span(sigmas).first(m)), mean, 4.0 * error) << m;
  }
}

TEST(ExpectedHypervolume, ItsDerivativesAreThoseOfItsValue) {
  for (const std::size_t m : {1U, 2U, 3U, 4U}) {
    Rng rng(7, Stream::kTest, m);
    const ExpectedHypervolume expected(some_front(m, 9, rng), Row(m, 1.1));
    Row means(m, 0.45);
    Row sigmas(m, 0.15);
    const ExpectedHypervolume::Gain gain = expected.gain(means, sigmas);
    EXPECT_DOUBLE_EQ(gain.value, expected.value(means, sigmas));
    constexpr double kStep = 1e-6;
    const auto derivative = [&](double& coordinate) {
      const double at = coordinate;
      coordinate = at + kStep;
      const double above = expected.value(means, sigmas);
      coordinate = at - kStep;
      const double below = expected.value(means, sigmas);
      coordinate = at;
      return (above - below) / (2.0 * kStep);
    };
    for (std::size_t k = 0; k < m; ++k) {
      EXPECT_NEAR(gain.by_mean[k], derivative(means[k]), 1e-7);
      EXPECT_NEAR(gain.by_sigma[k], derivative(sigmas[k]), 1e-7);
    }
  }
}

TEST(ExpectedHypervolume, WithoutAFrontIsTheVolumeBelowTheReference) {
  const ExpectedHypervolume expected({}, {1.0, 2.0});
  EXPECT_EQ(expected.num_boxes(), 1U);
  EXPECT_NEAR(expected.value(Row{0.5, 1.0}, Row{1e-9, 1e-9}), 0.5, 1e-8);
}

/// Two rows cut the plane below them into three boxes; a dominated one cuts nothing.
TEST(ExpectedHypervolume, LeavesOutWhatAddsNothing) {
  const std::vector<Row> front = {{0.2, 0.8}, {0.8, 0.2}, {0.9, 0.9}, {0.1, 3.0}};
  EXPECT_EQ(ExpectedHypervolume(front, {1.0, 1.0}).num_boxes(), 3U);
}

TEST(SpreadRows, KeepTheExtremesAndTheGapsSmall) {
  std::vector<Row> rows;
  for (int i = 0; i <= 100; ++i) {
    const double x = i <= 90 ? 0.001 * i : 0.09 + 0.091 * (i - 90);  // most of them crowded
    rows.push_back({x, 10.0 * (1.0 - x)});
  }
  const std::vector<std::size_t> kept = spread_rows(rows, 6);
  ASSERT_EQ(kept.size(), 6U);
  EXPECT_EQ(kept.front(), 0U);
  EXPECT_EQ(kept.back(), 100U);
  for (std::size_t i = 1; i < kept.size(); ++i) {
    EXPECT_LT(rows[kept[i]][0] - rows[kept[i - 1]][0], 0.3);
  }
  EXPECT_EQ(spread_rows(rows, 200).size(), rows.size());
}

}  // namespace
}  // namespace glint
