// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/stability.h"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "studies/stability/stability_pairs.h"

namespace glint::stability {
namespace {

Cell cell_with(double error, double bound, double uncertainty = 0.0) {
  Cell cell;
  cell.errors = {
      {.quantity = "picture", .error = error, .bound = bound, .uncertainty = uncertainty}};
  return cell;
}

TEST(Sweeps, HaveDistinctNamesAndAtLeastThreeCells) {
  std::set<std::string> names;
  for (const Sweep& sweep : all_sweeps()) {
    EXPECT_TRUE(names.insert(sweep.name).second) << sweep.name;
    EXPECT_GE(sweep.values.size(), 3U) << sweep.name;
    EXPECT_NE(sweep.title, "");
  }
  EXPECT_EQ(chosen_sweeps({"gain", "slot"}).size(), 2U);
  EXPECT_THROW(chosen_sweeps({"gian"}), ConfigError);
}

TEST(Judge, CallsAnErrorBeyondItsBoundWrongUnlessItIsTold) {
  Outcome harmless;
  harmless.notes = {"24 positions"};
  Outcome outcome;
  outcome.notes = {"8 positions"};
  Cell right = cell_with(0.9, 1.0);
  judge(outcome, &harmless, right);
  EXPECT_EQ(right.verdict, Verdict::kRight);
  Cell wrong = cell_with(1.1, 1.0);
  judge(outcome, &harmless, wrong);
  EXPECT_EQ(wrong.verdict, Verdict::kWrong) << "the same remark with another number tells nothing";
  outcome.notes.emplace_back("the picture clips");
  judge(outcome, &harmless, wrong);
  EXPECT_EQ(wrong.verdict, Verdict::kTold);
  EXPECT_EQ(wrong.message, "the picture clips");
}

// Leads of 0.7 and -0.6 points: the wrong design is ahead by 0.6.
TEST(FlipError, IsTheSmallerOfTheTwoLeads) {
  const DesignPair before{.h_first = 0.807, .h_second = 0.8};
  EXPECT_NEAR(flip_error(before, {.h_first = 0.8, .h_second = 0.806}, {}).error, 0.6, 1e-9);
  EXPECT_EQ(flip_error(before, {.h_first = 0.9, .h_second = 0.1}, {}).error, 0.0);
}

TEST(Stability, OfTwoSweepsJudgesEveryCell) {
  std::vector<Sweep> sweeps = chosen_sweeps({"positions_over_period", "part_size"});
  std::erase_if(sweeps[0].values, [](const SweepValue& v) { return v.value != 8 && v.value != 4; });
  std::erase_if(sweeps[1].values,
                [](const SweepValue& v) { return v.value != 20 && v.value > 0.5; });
  const Stability stability = measure_stability(sweeps, {});
  ASSERT_EQ(stability.sweeps.size(), 2U);
  EXPECT_EQ(stability.totals().wrong, 0);
  EXPECT_EQ(stability.totals().left_out, 0);
  const auto json = stability_json(stability);
  for (const auto& sweep : json["sweeps"]) {
    for (const auto& cell : sweep["cells"]) {
      EXPECT_NE(cell["verdict"], "silently wrong") << sweep["name"] << cell.dump(1);
      EXPECT_EQ(cell["verdict"] == "refused", cell["error"].is_null());
    }
  }
  EXPECT_EQ(stability.sweeps[1].cells.back().verdict, Verdict::kRefused) << "0.1 mm";
  EXPECT_THAT(stability.sweeps[1].cells.back().message,
              ::testing::HasSubstr("lighting.tunnel.radius_mm: is 0.105"));
}

/// What is told of a steep dent under a blur.
std::string told_of_dent(double slope_deg, const std::string& blur_px) {
  Sweep sweep = chosen_sweeps({"dent_slope_auto"}).front();
  sweep.sets.push_back({"sensor.blur_px", blur_px});
  const auto value = std::ranges::find(sweep.values, slope_deg, &SweepValue::value);
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto base = parse_toml(base_scene_text(), "base scene");
  std::string notes;
  for (const std::string& note : evaluated(store, scene_tables_of(base, sweep, *value)).notes) {
    notes += note + "\n";
  }
  return notes;
}

// 30 degrees: 3.8 mm deep over 16 mm, curvature 3.8 / 4^2 = 0.24 / mm; 193 mm below the wall a
// pixel of 1.2 mm sees 1.2 (1 + 2 0.24 193) = 111 mm of it, seven periods of 16 mm.
TEST(Evaluated, TellsOfStripesFarBelowAPixelInADentWhereThereIsBlur) {
  const char* note = "half a pixel in the middle of: dent_1 0.14 px";
  EXPECT_THAT(told_of_dent(30.0, "1"), ::testing::HasSubstr(note));
  EXPECT_THAT(told_of_dent(30.0, "0"), ::testing::Not(::testing::HasSubstr("half a pixel")));
  EXPECT_THAT(told_of_dent(0.2, "1"), ::testing::Not(::testing::HasSubstr("half a pixel")));
}

// A reference that is asked about another scene must find it wrong: the negative control.
TEST(Stability, FindsAWrongPicture) {
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto root = scene_tables_of(parse_toml(base_scene_text(), "base"),
                                    {},
                                    {.sets = {{"scan.positions", "4"}, {"defects", "{}"}}});
  Outcome outcome = evaluated(store, root);
  outcome.scene.tunnel.slot_mm += 6.0;  // the slot's mirror image is 10 % of the region
  Cell cell;
  cell.errors = errors_of_tunnel(outcome, {});
  judge(outcome, nullptr, cell);
  EXPECT_EQ(cell.verdict, Verdict::kWrong);
}

}  // namespace
}  // namespace glint::stability
