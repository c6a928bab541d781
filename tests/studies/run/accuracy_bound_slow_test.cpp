// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether the bound of the chosen rung holds for designs that were not tried, against pictures with
// other random numbers and many more samples: random path-traced scenes times scores.
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/rng.h"
#include "studies/accuracy/chosen_accuracy.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

constexpr int kScenes = 25;
constexpr int kDesigns = 3;  ///< of each scene, beside the twelve that were tried
constexpr int kTruthSamples = 1024;
constexpr int kOtherSeed = 7919;

/// A plate or a cylinder of rough metal with a dent, under a ring and sometimes a bar.
std::string random_study(Rng& rng) {
  const bool is_plate = rng.uniform() < 0.6;
  const bool has_bar = rng.uniform() < 0.5;
  std::string text = fmt::format(
      R"(schema = 1
[part]
shape = "{}"
length_mm = 12
{}
[material]
type = "conductor"
roughness = {:.3f}
[camera]
width_px = 60
height_px = 44
object_pixel_mm = 0.17
working_distance_mm = 100
[sensor]
bits = 0
[metrics]
erosion_px = 1
[render.paths]
samples = {}
max_reflections = {}
[defects.dent]
x_mm = [{:.2f}]
y_mm = [0]
height_um = {:.0f}
diameter_mm = {:.2f}
[lighting.ring]
inner_radius_mm = 15
outer_radius_mm = 25
height_mm = 30
)",
      is_plate ? "plate" : "cylinder",
      is_plate ? "width_mm = 8\nthickness_mm = 1" : "radius_mm = 6",
      rng.uniform(0.2, 0.7),
      rng.uniform() < 0.5 ? 16 : 32,
      rng.uniform() < 0.5 ? 1 : 3,
      rng.uniform(-2.0, 2.0),
      rng.uniform(20.0, 100.0),
      rng.uniform(1.2, 2.4));
  if (has_bar) {
    text +=
        "[lighting.bar]\nposition_mm = [-20, 0, 40]\ndirection = [20, 0, -40]\n"
        "length_mm = 20\nwidth_mm = 10\n";
  }
  return text + R"([variables]
"lighting.ring.inner_radius_mm" = { min = 5, max = 20 }
"lighting.ring.height_mm" = { min = 20, max = 60 }
[objective]
maximise = "defects.min_weber"
[accuracy]
keep = []
tolerance = { "homogeneity.h_rms" = "3 points", "homogeneity.mean" = "2 %", "defects.min_weber" = 0.1, "defects.min_cnr" = "30 %" }
)";
}

struct Tally {
  int checked = 0;
  int beyond = 0;
  int far_beyond = 0;  ///< beyond twice the bound
  double share_of_top = 0.0;
  int reached = 0;
};

void check_scene(std::uint64_t number, std::uint64_t seed, ThreadPool& pool, Tally& tally) {
  Rng rng(seed, Stream::kTest, number);
  const TemporaryFolder folder;
  write_file(folder / "study.toml", random_study(rng));
  const Study study = load_study(folder / "study.toml", {});
  SceneStore store(pool);
  const ChosenAccuracy chosen = choose_accuracy({.study = study, .store = store, .jobs = 2});
  ASSERT_EQ(chosen.choice.problem, "");
  tally.reached += chosen.choice.is_reached ? 1 : 0;
  tally.share_of_top += chosen.rung().work / chosen.top().work;
  Study other = study;
  other.scene.paths.seed += kOtherSeed;
  RenderRung truth = chosen.top();
  truth.paths.samples = kTruthSamples;
  for (int design = 0; design < kDesigns; ++design) {
    const Point point =
        point_from_unit(study.space, std::vector<double>{rng.uniform(), rng.uniform()});
    const Overrides overrides = overrides_of(study, point);
    const Outcome cheap = evaluate_at(store, study, overrides, chosen.rung());
    const Outcome dear = evaluate_at(store, other, overrides, truth);
    ASSERT_FALSE(cheap.is_failed || dear.is_failed) << cheap.message << dear.message;
    for (const ScoreBound& bound : chosen.choice.steps[chosen.choice.step].bounds) {
      const double error = std::abs(cheap.scores.at(bound.score) - dear.scores.at(bound.score));
      ++tally.checked;
      tally.beyond += error > bound.bound ? 1 : 0;
      tally.far_beyond += error > 2.0 * bound.bound ? 1 : 0;
    }
  }
}

TEST(AccuracyBound, HoldsForDesignsThatWereNotTried) {
  std::random_device entropy;
  for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{entropy()}}) {
    ThreadPool pool(2);
    Tally tally;
    for (std::uint64_t number = 0; number < kScenes; ++number) {
      check_scene(number, seed, pool, tally);
    }
    fmt::print(
        "seed {}: {} of {} errors beyond the bound of 99 %, {} beyond twice; tolerances reached in "
        "{} of {} scenes; work of the chosen rung {:.0f} % of the top's\n",
        seed,
        tally.beyond,
        tally.checked,
        tally.far_beyond,
        tally.reached,
        kScenes,
        100.0 * tally.share_of_top / kScenes);
    EXPECT_LE(tally.beyond, 0.02 * tally.checked);
    EXPECT_EQ(tally.far_beyond, 0);
    EXPECT_GT(tally.reached, kScenes / 2);
  }
}

}  // namespace
}  // namespace glint
