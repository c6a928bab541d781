// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "studies/stability/stability.h"

namespace glint::stability {
namespace {

/// Cells that are known to be beyond the bound of contrast and are told of in docs/stability.md.
bool is_known(const std::string& sweep) {
  return sweep == "wall_over_part";
}

constexpr double kKnownExcess = 1.3;  ///< in bounds

TEST(Stability, OfAllSweepsIsSilentlyWrongNowhereButWhereKnown) {
  const Stability stability = measure_stability(all_sweeps(), {.threads = 2});
  EXPECT_EQ(stability.totals().left_out, 0);
  EXPECT_GT(stability.totals().right, 100);
  for (const SweepResult& result : stability.sweeps) {
    for (const Cell& cell : result.cells) {
      const CellError* worst = worst_of(cell);
      if (cell.verdict == Verdict::kWrong && is_known(result.sweep.name)) {
        EXPECT_EQ(worst->quantity, "contrast_percent");
        EXPECT_LT(worst->error, kKnownExcess * worst->bound) << result.sweep.name;
        continue;
      }
      EXPECT_NE(cell.verdict, Verdict::kWrong) << result.sweep.name << " at " << cell.value << ": "
                                               << (worst != nullptr ? worst->error : 0.0) << " "
                                               << (worst != nullptr ? worst->quantity : "");
    }
  }
}

}  // namespace
}  // namespace glint::stability
