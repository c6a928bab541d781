// SPDX-License-Identifier: GPL-3.0-or-later
//
// Half resolution as a rung of a path-traced plate with a dent: two lamps, so that no sum serves.
#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/accuracy/accuracy_report.h"
#include "studies/accuracy/chosen_accuracy.h"
#include "studies/accuracy/search_review.h"
#include "tests/support/temporary_folder.h"

namespace glint::half_resolution_rung_test {
namespace {

constexpr const char* kH = "homogeneity.h_rms";

const char* const kText = R"(schema = 1
[part]
shape = "plate"
length_mm = 46
width_mm = 34
thickness_mm = 3
[material]
type = "conductor"
roughness = 0.4
[camera]
width_px = 96
height_px = 72
object_pixel_mm = 0.4
working_distance_mm = 300
[sensor]
bits = 0
full_well_e = 0
[metrics]
erosion_px = 2
[render.paths]
samples = 16
max_reflections = 2
[lighting.ring]
height_mm = 60
[lighting.bar]
position_mm = [-60, 0, 80]
direction = [60, 0, -80]
length_mm = 40
width_mm = 10
[variables]
"lighting.ring.inner_radius_mm" = { min = 10, max = 25 }
"lighting.ring.outer_radius_mm" = { min = 30, max = 60 }
[objective]
maximise = "homogeneity.h_rms"
[search]
algorithm = "random"
[budget]
evaluations = 20
[accuracy]
)";

/// With a study that lives as long as what was chosen for it.
struct Chosen {
  explicit Chosen(const std::string& accuracy) {
    write_file(folder / "study.toml", kText + accuracy);
    study = load_study(folder / "study.toml", {});
    chosen = choose_accuracy({.study = study, .store = store, .jobs = 1});
  }

  void print_bounds() const {
    for (std::size_t i = 0; i < chosen.ladder.size(); ++i) {
      for (const ScoreBound& bound : chosen.choice.steps[i].bounds) {
        fmt::print("\"{}\": {} within {:.4f}\n", chosen.ladder[i].name, bound.score, bound.bound);
      }
    }
  }

  TemporaryFolder folder;
  ThreadPool pool{2};
  SceneStore store{pool};
  Study study;
  ChosenAccuracy chosen;
};

/// Tried once for all tests.
Chosen& lax() {
  static Chosen chosen("keep = []\ntolerance = { \"homogeneity.h_rms\" = \"25 points\" }\n");
  return chosen;
}

TEST(HalfResolutionRung, ServesWhereItIsTheCheapestWithinTheTolerance) {
  Chosen& found = lax();
  ASSERT_TRUE(found.chosen.choice.is_reached);
  const RenderRung& rung = found.chosen.rung();
  EXPECT_EQ(rung.level, "half resolution") << rung.name;
  EXPECT_GT(std::abs(rung.offsets.at(kH)), 0.0);
  found.print_bounds();
}

// What the search is given of the trial's designs is what it would evaluate, without the mean
// error; the mean of both rungs over the trial's designs is then the same.
TEST(HalfResolutionRung, ScoresOfTheSearchAreCorrected) {
  Chosen& found = lax();
  ASSERT_FALSE(found.chosen.known.empty());
  double difference = 0.0;
  for (const auto& [point, outcome] : found.chosen.known) {
    const Overrides overrides = overrides_of(found.study, point);
    Scores own = evaluate_at(found.store, found.study, overrides, found.chosen.rung()).scores;
    const double half = own.at(kH);
    less_offsets(scene_with(found.study, overrides), found.chosen.rung(), own);
    EXPECT_EQ(outcome.scores.at(kH), own.at(kH));
    EXPECT_NE(own.at(kH), half);
    difference +=
        own.at(kH) -
        evaluate_at(found.store, found.study, overrides, found.chosen.top()).scores.at(kH);
  }
  EXPECT_NEAR(difference / static_cast<double>(found.chosen.known.size()), 0.0, 1e-12);
}

TEST(HalfResolutionRung, IsCheckedByAllPixelsWithTheirMeanErrorsTakenOut) {
  Chosen& found = lax();
  const RenderRung* second = second_rung(found.chosen);
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(second->pixel_factor, 1);
  EXPECT_GE(second->paths.samples, found.chosen.rung().paths.samples);
  int number = 0;
  for (const auto& [point, outcome] : found.chosen.known) {
    const Trial trial = {.number = ++number, .point = point, .outcome = outcome};
    const Outcome dearer =
        evaluate_at(found.store, found.study, overrides_of(found.study, point), *second);
    EXPECT_TRUE(compared(found.chosen, trial, false, *second, dearer).beyond.empty()) << number;
  }
}

TEST(HalfResolutionRung, TellsWhatItsScoresAreCorrectedBy) {
  Chosen& found = lax();
  const auto told = accuracy_json(found.study, found.chosen, 20, {});
  EXPECT_EQ(told["settings"]["resolution"], "half");
  EXPECT_EQ(told["offsets"][kH], found.chosen.rung().offsets.at(kH));
  EXPECT_THAT(told["sentence"].get<std::string>(), testing::HasSubstr("mean error"));
  write_file(found.folder / "result.json", nlohmann::ordered_json{{"accuracy", told}}.dump());
  const std::optional<SearchRungs> read = rungs_of_run(found.study, found.folder.path());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->rungs.front().offsets, found.chosen.rung().offsets);
}

TEST(HalfResolutionRung, IsLeftOutWhereTheCameraIsKept) {
  Chosen found(
      "keep = [\"camera.width_px\"]\ntolerance = { \"homogeneity.h_rms\" = \"25 points\" }\n");
  EXPECT_TRUE(std::ranges::none_of(found.chosen.ladder,
                                   [](const RenderRung& rung) { return rung.pixel_factor > 1; }));
}

}  // namespace
}  // namespace glint::half_resolution_rung_test
