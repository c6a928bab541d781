// SPDX-License-Identifier: GPL-3.0-or-later
//
// Some changes of small rendered pictures that `glint compare` names; all of them, large and in
// twos, in compare_changes_test.cpp.
#include "tests/cli/changes/known_changes.h"

namespace glint::test {
namespace {

TEST(KnownChange, IsNamedInSmallPictures) {
  ChangedGear gear(400, 8);
  const std::vector<Change>& all = known_changes();
  // Turns about x and z, a shift, the distance, the lens; then a turn and the centre together.
  const std::vector<std::vector<Change>> cases = {
      {all[0]}, {all[2]}, {all[4]}, {all[5]}, {all[9]}, {all[1], all[7]}};
  int changes = 0;
  int named = 0;
  int others = 0;
  int seed = 2;
  for (const std::vector<Change>& one : cases) {
    const CaseVerdict verdict = gear.verdict_of(one, seed++);
    changes += static_cast<int>(one.size());
    named += verdict.named;
    others += verdict.others;
    std::printf("%s %s: %s\n",
                name_of(one[0].parameter).c_str(),
                one.size() > 1 ? name_of(one[1].parameter).c_str() : "",
                gear.last().c_str());
    for (const double off : verdict.off) {
      EXPECT_LT(std::abs(off), 5.0) << gear.last();
    }
  }
  EXPECT_EQ(named, changes);
  EXPECT_LE(others, 1);
  EXPECT_TRUE(gear.causes_of({}, 40).empty()) << gear.last();
}

}  // namespace
}  // namespace glint::test
