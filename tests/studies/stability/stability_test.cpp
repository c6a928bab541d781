// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/stability.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "studies/definition/scene_notes.h"
#include "studies/stability/note_coverage.h"
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

// 100 x 100 pixels of 0.1 mm are 89 x 89 of 0.1118: stripes of 50 pixels are 5.59 mm.
TEST(Sweeps, OfAnotherSceneAreRelativeToItsOwnSizes) {
  SceneSettings scene;
  scene.camera.width_px = scene.camera.height_px = 100;
  scene.camera.object_pixel_mm = 0.1;
  scene.tunnel.period_mm = 4.8;
  scene.tunnel_name = "wall";
  const SweptScene swept = swept_scene(scene);
  const SweepValue stripes = chosen_sweeps({"stripe_over_pixel"}, swept)[0].values[0];
  EXPECT_EQ(stripes.sets[0].path, "lighting.wall.period_mm");
  EXPECT_NEAR(std::stod(stripes.sets[0].value), 50.0 * 0.1 * std::sqrt(10000.0 / 8000.0), 1e-9);
  const SweepValue travel = chosen_sweeps({"travel_over_period"}, swept)[0].values[0];
  EXPECT_NEAR(std::stod(travel.sets[0].value), 4.8 / 24.0, 1e-9);
  EXPECT_THROW(chosen_sweeps({"part_size"}, swept), ConfigError);
  EXPECT_FALSE(chosen_sweeps({}, swept).empty());
  for (const Sweep& sweep : all_sweeps(swept)) {
    EXPECT_NE(sweep.kind, Sweep::Kind::kWinner) << sweep.name;
  }
}

// Corners that are 1e-14 mm apart are the same to within the digits of 95 mm.
TEST(Slivers, LeaveAPlateWhatItIs) {
  std::vector<Sweep> sweeps = chosen_sweeps({"slivers"});
  std::erase_if(sweeps[0].values,
                [](const SweepValue& v) { return v.value != 1.0 && v.value > 1e-12; });
  const Stability stability = measure_stability(sweeps, {});
  EXPECT_EQ(stability.totals().right, 3);
  for (const Cell& cell : stability.sweeps[0].cells) {
    for (const CellError& error : cell.errors) {
      EXPECT_LT(error.error, 0.2 * error.bound) << cell.value << " " << error.quantity;
    }
  }
}

TEST(Judge, CallsAnErrorBeyondItsBoundWrongUnlessItIsTold) {
  Outcome harmless;
  harmless.notes = {{.text = "24 positions"}, {NoteKind::kRipple, "a ripple over 24 positions."}};
  Outcome outcome;
  outcome.notes = {{.text = "8 positions"}, {NoteKind::kRipple, "a ripple over 8 positions."}};
  Cell right = cell_with(0.9, 1.0);
  judge(outcome, &harmless, right);
  EXPECT_EQ(right.verdict, Verdict::kRight);
  Cell wrong = cell_with(1.1, 1.0);
  judge(outcome, &harmless, wrong);
  EXPECT_EQ(wrong.verdict, Verdict::kWrong) << "the harmless cell has a ripple, too";
  outcome.notes.push_back({NoteKind::kRepeatedBorder, "the border's pixels are repeated."});
  judge(outcome, &harmless, wrong);
  EXPECT_EQ(wrong.verdict, Verdict::kTold);
  EXPECT_EQ(wrong.message, outcome.notes.back().text);
}

TEST(Judge, ANoteCoversTheQuantitiesOfItsKindAlone) {
  const Outcome harmless;
  Outcome outcome;
  outcome.notes = {{.text = "Light ring, radii 25 to 40 mm: the flawless surface shows a ripple."},
                   {NoteKind::kRipple, "of a kind, whatever its words are."}};
  const auto verdict_on = [&](const std::vector<CellError>& errors) {
    Cell cell{.errors = errors};
    judge(outcome, &harmless, cell);
    return cell.verdict;
  };
  const CellError h{.quantity = "h_points", .error = 2.0, .bound = 0.5};
  const CellError contrast{.quantity = "contrast_percent", .error = 28.0, .bound = 5.0};
  EXPECT_EQ(verdict_on({h}), Verdict::kTold);
  EXPECT_EQ(verdict_on({contrast}), Verdict::kWrong) << "a ripple is no contrast";
  EXPECT_EQ(verdict_on({h, contrast}), Verdict::kWrong);
  outcome.notes.push_back({NoteKind::kFineStripes, "stripes are fine."});
  EXPECT_EQ(verdict_on({h, contrast}), Verdict::kTold);
  outcome.notes.erase(outcome.notes.begin() + 1);
  EXPECT_EQ(verdict_on({h}), Verdict::kWrong) << "what a scene is excuses nothing";
}

TEST(Judge, TellsEachErrorByItsOwnNote) {
  const Outcome harmless;
  const Outcome outcome{.notes = {{NoteKind::kRipple, "There is a ripple."},
                                  {NoteKind::kFineStripes, "Stripes are fine."},
                                  {NoteKind::kRepeatedBorder, "Blur is wide."}}};
  Cell cell;
  cell.errors = {{.quantity = "h_points", .error = 2.0, .bound = 0.5},
                 {.quantity = "mean", .error = 0.02, .bound = 0.01},
                 {.quantity = "contrast_percent", .error = 28.0, .bound = 5.0}};
  judge(outcome, &harmless, cell);
  EXPECT_EQ(cell.message, "There is a ripple. Blur is wide. Stripes are fine.") << "each once";
}

/// One or more of all kinds that tell of an error.
std::vector<SceneNote> notes_of_faults() {
  SceneSettings scene;
  scene.scan.positions = 25;
  scene.sensor.blur_px = 25.0;
  scene.sensor.full_well_e = 100.0;
  scene.tunnel.period_mm = 0.5;
  scene.defects = {{"dent", DefectGroup{}}};
  std::vector<SceneNote> notes = scene_notes(
      scene,
      {{"homogeneity.clipped_share", 0.5}, {"view.hidden_share", 0.5}, {"rays.max_cells", 4.0}});
  Sweep sweep = chosen_sweeps({"dent_over_pixel"}).front();
  const auto value = std::ranges::find(sweep.values, 1.0, &SweepValue::value);
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto base = parse_toml(base_scene_text(), "base scene");
  std::ranges::copy(evaluated(store, scene_tables_of(base, sweep, *value)).notes,
                    std::back_inserter(notes));
  return notes;
}

TEST(NoteCoverage, IsOfKindsThatTheProgramTells) {
  const std::vector<SceneNote> notes = notes_of_faults();
  for (const NoteCoverage& coverage : note_coverages()) {
    const auto note = std::ranges::find(notes, coverage.kind, &SceneNote::kind);
    ASSERT_NE(note, notes.end()) << coverage.quantities.front();
    EXPECT_NE(coverage.kind, NoteKind::kScene) << note->text;
    EXPECT_EQ(told_of(coverage.quantities.front(), std::span(&*note, 1)), std::vector{note->text});
  }
}

// The contrast is 4 bounds off, by a reference that is not sure of it; the picture certainly 1.5.
TEST(Judge, LooksAtEachErrorByItself) {
  Outcome outcome;
  Cell cell = cell_with(4.0, 1.0, 3.5);
  judge(outcome, nullptr, cell);
  EXPECT_EQ(cell.verdict, Verdict::kRight);
  cell.errors.push_back({.quantity = "contrast_percent", .error = 1.5, .bound = 1.0});
  judge(outcome, nullptr, cell);
  EXPECT_EQ(cell.verdict, Verdict::kWrong);
}

// A standard error of 1 point tells of h being 2 points off, and of no picture.
TEST(Judge, AWordAboutOneErrorTellsNothingOfAnother) {
  Outcome outcome;
  outcome.evaluation.scores["homogeneity.h_rms.error"] = 0.01;
  Cell cell = cell_with(0.015, 0.01);
  cell.errors.push_back({.quantity = "h_points", .error = 2.0, .bound = 0.5});
  judge(outcome, nullptr, cell);
  EXPECT_EQ(cell.verdict, Verdict::kWrong);
  cell.errors.erase(cell.errors.begin());
  judge(outcome, nullptr, cell);
  EXPECT_EQ(cell.verdict, Verdict::kTold);
}

// Leads of 0.7 and -0.6 points: the wrong design is ahead by 0.6.
TEST(FlipError, IsTheSmallerOfTheTwoLeads) {
  const DesignPair before{.h_first = 0.807, .h_second = 0.8};
  EXPECT_NEAR(flip_error(before, {.h_first = 0.8, .h_second = 0.806}, {}).error, 0.6, 1e-9);
  EXPECT_EQ(flip_error(before, {.h_first = 0.9, .h_second = 0.1}, {}).error, 0.0);
}

TEST(Sweeps, HaveASwitchBetweenAllKindsOfRungs) {
  std::set<std::string> names;
  for (const Sweep& sweep : all_sweeps()) {
    if (sweep.kind == Sweep::Kind::kSwitch) {
      names.insert(sweep.name);
    }
  }
  EXPECT_THAT(names,
              ::testing::UnorderedElementsAre("switches",
                                              "switches_blurred",
                                              "switches_direct",
                                              "switches_half_resolution",
                                              "switches_reflections"));
  const Sweep reflections = chosen_sweeps({"switches_reflections"}).front();
  EXPECT_EQ(reflections.values.front().value, 8);
  EXPECT_EQ(reflections.values.back().value, 1) << "direct light alone";
}

/// A dent of each change, all with the same h and mean.
Outcome with_changes(const std::vector<double>& changes) {
  Outcome outcome;
  outcome.evaluation.scores = {{"homogeneity.h_rms", 0.8}, {"homogeneity.mean", 0.5}};
  for (const double change : changes) {
    DefectScores dent;
    dent.label = "dent_" + std::to_string(outcome.evaluation.defects.size() + 1);
    dent.change = change;
    outcome.evaluation.defects.push_back(dent);
  }
  return outcome;
}

// 0.1 and 0.106 are 6 % apart; 0.001 and 0.0015 only 5 % of 0.01.
TEST(ErrorsOfSwitch, CompareTheChangesOfDefects) {
  const Outcome before = with_changes({0.001, 0.1});
  Cell cell{.errors = errors_of_switch(with_changes({0.0015, 0.106}), before, {})};
  EXPECT_EQ(worst_of(cell)->quantity, "contrast_percent");
  EXPECT_NEAR(worst_of(cell)->error, 6.0, 1e-9);
  judge(before, &before, cell);
  EXPECT_EQ(cell.verdict, Verdict::kWrong);
  cell.errors = errors_of_switch(with_changes({0.0013, 0.1}), before, {});
  EXPECT_NEAR(worst_of(cell)->error, 3.0, 1e-9);
  EXPECT_EQ(errors_of_switch(with_changes({}), with_changes({}), {}).size(), 2U);
}

TEST(Stability, SwitchesToHalfResolutionWithItsContrast) {
  std::vector<Sweep> sweeps = chosen_sweeps({"switches_half_resolution"});
  sweeps.front().values.pop_back();
  const Stability stability = measure_stability(sweeps, {});
  const Cell& half = stability.sweeps.front().cells.at(1);
  EXPECT_EQ(half.verdict, Verdict::kRight);
  const auto contrast = std::ranges::find(half.errors, "contrast_percent", &CellError::quantity);
  ASSERT_NE(contrast, half.errors.end());
  EXPECT_GT(contrast->error, 0.1) << "as of larger pixels";
  EXPECT_GT(contrast->reference, 2.0 * kMinContrast);
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
  for (const SceneNote& note : evaluated(store, scene_tables_of(base, sweep, *value)).notes) {
    notes += note.text + "\n";
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
