// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "studies/stability/stability.h"

namespace glint::stability {
namespace {

/// The steepest cell of a sweep, with a blur.
Cell steepest_dent(const std::string& name, const std::string& blur_px) {
  std::vector<Sweep> sweeps = chosen_sweeps({name});
  std::erase_if(sweeps[0].values,
                [](const SweepValue& v) { return v.value != 0.2 && v.value != 30.0; });
  sweeps[0].sets.push_back({"sensor.blur_px", blur_px});
  return measure_stability(sweeps, {.threads = 2}).sweeps[0].cells.back();
}

// The blur, not the slope and not the realisation, is what makes the change of a steep dent wrong.
TEST(StripesInADent, FarBelowAPixelAreRightWithoutBlurAndToldOfWithIt) {
  for (const std::string name : {"dent_slope_normal", "dent_slope_auto"}) {
    const Cell sharp = steepest_dent(name, "0");
    EXPECT_EQ(sharp.verdict, Verdict::kRight) << name;
    EXPECT_LT(worst_of(sharp)->error, 0.5 * worst_of(sharp)->bound) << name;
    const Cell blurred = steepest_dent(name, "1");
    EXPECT_NE(blurred.verdict, Verdict::kWrong) << name;
    EXPECT_GT(worst_of(blurred)->error, 4.0) << "else nothing needs to be told";
  }
}

TEST(Stability, OfAllSweepsIsSilentlyWrongNowhere) {
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
