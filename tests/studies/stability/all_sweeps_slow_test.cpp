// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "studies/stability/stability.h"

namespace glint::stability {
namespace {

TEST(Stability, OfAllSweepsIsNowhereSilentlyWrong) {
  const Stability stability = measure_stability(all_sweeps(), {.threads = 2});
  EXPECT_EQ(stability.totals().left_out, 0);
  EXPECT_GT(stability.totals().right, 100);
  for (const SweepResult& result : stability.sweeps) {
    for (const Cell& cell : result.cells) {
      const CellError* worst = worst_of(cell);
      EXPECT_NE(cell.verdict, Verdict::kWrong) << result.sweep.name << " at " << cell.value << ": "
                                               << (worst != nullptr ? worst->error : 0.0) << " "
                                               << (worst != nullptr ? worst->quantity : "");
    }
  }
}

}  // namespace
}  // namespace glint::stability
