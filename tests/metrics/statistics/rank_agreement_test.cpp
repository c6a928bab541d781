// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/rank_agreement.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

namespace glint {
namespace {

constexpr std::array kNoErrors = {0.0, 0.0, 0.0, 0.0};

TEST(RankAgreement, IsOneOfTheSameOrderAndMinusOneOfTheOpposite) {
  const std::array reference = {1.0, 2.0, 3.0, 4.0};
  const RankAgreement same =
      rank_agreement(std::array{10.0, 11.0, 19.0, 20.0}, reference, kNoErrors);
  EXPECT_EQ(same.tau, 1.0);
  EXPECT_EQ(same.pairs, 6U);
  EXPECT_TRUE(is_ranking_right(same));
  const RankAgreement opposite =
      rank_agreement(std::array{4.0, 3.0, 2.0, 1.0}, reference, kNoErrors);
  EXPECT_EQ(opposite.tau, -1.0);
  EXPECT_EQ(opposite.winner, 3U);
  EXPECT_EQ(opposite.winner_behind, 3.0);
  EXPECT_FALSE(is_ranking_right(opposite));
}

// One pair of six is wrong: (5 - 1) / 6.
TEST(RankAgreement, CountsPairs) {
  const RankAgreement one_wrong =
      rank_agreement(std::array{1.0, 2.0, 4.0, 3.0}, std::array{1.0, 2.0, 3.0, 4.0}, kNoErrors);
  EXPECT_DOUBLE_EQ(one_wrong.tau, 4.0 / 6.0);
  EXPECT_EQ(one_wrong.winner_behind, 0.0);
  EXPECT_FALSE(is_ranking_right(one_wrong));
  EXPECT_TRUE(is_ranking_right(one_wrong, 0.6));
}

TEST(RankAgreement, LeavesOutWhatTheReferenceCannotTellApart) {
  const std::array errors = {0.01, 0.01, 0.4, 0.4};
  const RankAgreement agreement =
      rank_agreement(std::array{1.0, 2.0, 4.0, 3.0}, std::array{1.0, 2.0, 3.0, 4.0}, errors);
  EXPECT_EQ(agreement.pairs, 5U);
  EXPECT_EQ(agreement.tau, 1.0);
  EXPECT_TRUE(is_ranking_right(agreement));
}

// All other pairs are right, but what wins is worse than the best by more than its noise.
TEST(RankAgreement, LooksAtTheWinnerToo) {
  const std::array cheap = {2.0, 1.0, 3.0, 4.0};
  const std::array reference = {1.0, 1.5, 3.0, 4.0};
  const RankAgreement clear = rank_agreement(cheap, reference, std::array{0.1, 0.1, 0.1, 0.1});
  EXPECT_EQ(clear.winner, 1U);
  EXPECT_DOUBLE_EQ(clear.winner_behind, 0.5);
  EXPECT_FALSE(is_ranking_right(clear, 0.5));
  const RankAgreement noisy = rank_agreement(cheap, reference, std::array{0.2, 0.2, 0.1, 0.1});
  EXPECT_EQ(noisy.tau, 1.0);
  EXPECT_TRUE(is_ranking_right(noisy));
}

TEST(RankAgreement, OfTiesInTheCheapFigureIsNeitherRightNorWrong) {
  const RankAgreement blind =
      rank_agreement(std::array{1.0, 1.0, 1.0, 1.0}, std::array{1.0, 2.0, 3.0, 4.0}, kNoErrors);
  EXPECT_EQ(blind.tau, 0.0);
  EXPECT_EQ(blind.pairs, 6U);
}

TEST(RankAgreement, ShowsNothingWhereNothingCanBeToldApart) {
  const std::array same = {1.0, 1.0, 1.0, 1.0};
  const RankAgreement agreement = rank_agreement(same, same, kNoErrors);
  EXPECT_EQ(agreement.pairs, 0U);
  EXPECT_FALSE(is_ranking_right(agreement));
}

TEST(RankAgreementDeathTest, RefusesWhatHasNoOrder) {
  EXPECT_DEATH(rank_agreement(std::array{1.0}, std::array{1.0}, std::array{0.0}), "two things");
  EXPECT_DEATH(rank_agreement(std::array{1.0, 2.0}, std::array{1.0}, std::array{0.0}),
               "one figure");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_DEATH(rank_agreement(std::array{1.0, nan}, std::array{1.0, 2.0}, std::array{0.0, 0.0}),
               "finite");
}

}  // namespace
}  // namespace glint
