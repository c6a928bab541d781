// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

/// The outcome of an evaluation with derivatives.
Outcome outcome_with(std::vector<Remark> remarks, const std::string& message = "") {
  return {.scores = {{"h", 0.5}},
          .message = message,
          .remarks = std::move(remarks),
          .gradients = {{"h", {1.0}}}};
}

std::vector<std::string> derivative_remarks_of(const std::vector<Outcome>& outcomes) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "s.sqlite", {.config_hash = "abc"});
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    storage.put_trial({.number = static_cast<int>(i) + 1, .point = {1.0}, .outcome = outcomes[i]});
  }
  return derivative_remarks(storage);
}

TEST(DerivativeRemarks, StandOnceEachWithTheRangeOfTheirCounts) {
  const Remark wall = {.count = {}, .text = "the edge of the wall is held"};
  EXPECT_THAT(derivative_remarks_of({outcome_with({{.count = 71, .text = "pixels are held"}, wall}),
                                     outcome_with({{.count = 64, .text = "pixels are held"}}),
                                     outcome_with({})}),
              ::testing::ElementsAre("64 to 71 pixels are held (2 of 3 evaluations)",
                                     "the edge of the wall is held (1 of 3 evaluations)"));
}

// Neither a separator nor digits in front make two remarks, or a count, of one text.
TEST(DerivativeRemarks, AreNotReadFromTheirTexts) {
  EXPECT_THAT(
      derivative_remarks_of({outcome_with({{.count = {}, .text = "3 lights | 4 walls are held"}})}),
      ::testing::ElementsAre("3 lights | 4 walls are held (1 of 1 evaluations)"));
}

// Until schema 2 the remarks stood as one text in the message of a success.
TEST(DerivativeRemarks, OfARunBegunByAnEarlierVersionCountWithTheNewOnes) {
  EXPECT_THAT(
      derivative_remarks_of({outcome_with({}, "71 pixels are held | the edge of the wall is held"),
                             outcome_with({{.count = 80, .text = "pixels are held"}})}),
      ::testing::ElementsAre("71 to 80 pixels are held (2 of 2 evaluations)",
                             "the edge of the wall is held (1 of 2 evaluations)"));
}

}  // namespace
}  // namespace glint
