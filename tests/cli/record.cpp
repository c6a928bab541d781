// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/cli/record.h"

#include "optimizer/storage/storage.h"

namespace glint::test {

std::map<int, Outcome> recorded_evaluations(const std::filesystem::path& out) {
  std::map<int, Outcome> outcomes;
  if (!std::filesystem::exists(out / "study.sqlite")) {
    return outcomes;
  }
  const Storage storage = Storage::read(out / "study.sqlite");
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    if (trial.outcome) {
      outcomes[trial.number] = *trial.outcome;
    }
  }
  return outcomes;
}

void expect_kept(const std::map<int, Outcome>& before, const std::map<int, Outcome>& after) {
  for (const auto& [number, outcome] : before) {
    const auto found = after.find(number);
    ASSERT_NE(found, after.end()) << "trial " << number << " is lost";
    EXPECT_EQ(found->second.seconds, outcome.seconds) << "trial " << number << " ran again";
    EXPECT_EQ(found->second.scores, outcome.scores);
  }
}

}  // namespace glint::test
