// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/far_questions.h"

#include <gtest/gtest.h>

#include <vector>

namespace glint {
namespace {

/// Which of so many questions were far, each told at once.
std::vector<std::uint64_t> far_ones(FarQuestions questions, std::uint64_t count, bool keeps) {
  std::vector<std::uint64_t> far;
  for (std::uint64_t k = 0; k < count; ++k) {
    const Point point = {static_cast<double>(k)};
    if (questions.is_due(k)) {
      questions.note(point, k);
      far.push_back(k);
    }
    questions.judge(point, keeps);
  }
  return far;
}

TEST(FarQuestions, AreEveryFourthWhereNothingIsMissed) {
  const std::vector<std::uint64_t> fourth = {0, 4, 8, 12, 16, 20};
  EXPECT_EQ(far_ones(FarQuestions(true), 24, true), fourth);
  EXPECT_EQ(far_ones(FarQuestions(false), 24, false), fourth) << "by rules 5 whatever comes out";
}

TEST(FarQuestions, WaitTwiceAsLongAfterEachThatMissesALimit) {
  EXPECT_EQ(far_ones(FarQuestions(true), 130, false),
            (std::vector<std::uint64_t>{0, 8, 24, 56, 88, 120}));
}

/// With a batch the answer comes later: the wait that began with the question is made longer or
/// shorter then.
TEST(FarQuestions, AreJudgedWhenTheyAreTold) {
  FarQuestions questions(true);
  questions.note({1.0}, 0);
  EXPECT_FALSE(questions.is_due(3));
  questions.judge({7.0}, true);  // another question
  EXPECT_TRUE(questions.is_due(4));
  questions.judge({1.0}, false);
  EXPECT_FALSE(questions.is_due(7));
  EXPECT_TRUE(questions.is_due(8));
  questions.note({2.0}, 8);
  EXPECT_FALSE(questions.is_due(15));
  questions.judge({2.0}, true);
  EXPECT_TRUE(questions.is_due(12));
}

}  // namespace
}  // namespace glint
