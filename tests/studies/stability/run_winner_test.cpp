// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stability of a winner, of runs whose folders are made up: three designs of a small tunnel.
#include "studies/stability/run_winner.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "optimizer/storage/storage.h"
#include "tests/support/temporary_folder.h"

namespace glint::stability {
namespace {

using ::testing::HasSubstr;

std::string small_study(const std::string& sensor) {
  return R"(schema = 1
[part]
shape = "cylinder"
length_mm = 12
radius_mm = 6
[camera]
width_px = 48
height_px = 32
object_pixel_mm = 0.2
working_distance_mm = 100
[metrics]
erosion_px = 1
[scan]
positions = 4
[lighting.tunnel]
[variables]
"lighting.tunnel.duty" = { min = 0.3, max = 0.7 }
"lighting.tunnel.radius_mm" = { min = 60, max = 120 }
[objective]
maximise = "homogeneity.h_rms"
[search]
algorithm = "random"
[budget]
evaluations = 10
[sensor]
)" + sensor;
}

Trial trial_at(int number, const Point& point, double h) {
  return {.number = number,
          .name = "",
          .point = point,
          .outcome = glint::Outcome{
              .scores = {{"homogeneity.h_rms", h}, {"homogeneity.clipped_share", 0.0}}}};
}

/// A finished run of these trials, whose best is named.
void make_run(const TemporaryFolder& folder,
              const std::string& sensor,
              const std::vector<Trial>& trials,
              int best) {
  write_file(folder / "study.resolved.toml", small_study(sensor));
  write_file(folder / "result.json", "{\"best\": {\"trial\": " + std::to_string(best) + "}}\n");
  Storage storage = Storage::open(folder / "study.sqlite", {.config_hash = "test"});
  for (const Trial& trial : trials) {
    storage.put_trial(trial);
  }
}

const Point kDark = {0.35, 60.0};
const Point kBright = {0.65, 110.0};

TEST(RunnersUp, LeaveOutDesignsThatAreTheWinnerButForDigits) {
  const TemporaryFolder folder;
  make_run(folder,
           "blur_px = 0",
           {trial_at(1, kDark, 0.5),
            trial_at(2, kBright, 0.9),
            trial_at(3, {0.651, 110.0}, 0.89),
            trial_at(4, {0.5, 110.0}, 0.7)},
           2);
  const RunnersUp found = runners_up(folder.path());
  EXPECT_EQ(found.winner_trial, 2);
  EXPECT_EQ(found.winner, kBright);
  EXPECT_EQ(found.second_trial, 4) << "3 is 0.0025 of a range away";
}

TEST(RunnersUp, OfAllDesignsNearTheWinnerTheNextBestIsTaken) {
  const TemporaryFolder folder;
  make_run(folder, "blur_px = 0", {trial_at(1, kBright, 0.9), trial_at(2, {0.651, 110}, 0.8)}, 1);
  EXPECT_EQ(runners_up(folder.path()).second_trial, 2);
}

TEST(RunnersUp, RefuseARunWithoutAWinnerOrWithOneDesign) {
  const TemporaryFolder folder;
  make_run(folder, "blur_px = 0", {trial_at(1, kBright, 0.9)}, 1);
  EXPECT_THROW(runners_up(folder.path()), ConfigError);
  write_file(folder / "result.json", "{\"best\": null}\n");
  EXPECT_THROW(runners_up(folder.path()), ConfigError);
}

TEST(MeasureWinner, ADesignThatIsClearlyBetterStaysSo) {
  const TemporaryFolder folder;
  make_run(folder, "blur_px = 1", {trial_at(1, kDark, 0.5), trial_at(2, kBright, 0.9)}, 2);
  const RunnersUp found = runners_up(folder.path());
  const Stability stability = measure_winner(found, {.threads = 2});
  ASSERT_EQ(stability.sweeps.size(), 3U);
  EXPECT_EQ(stability.sweeps[0].cells.size(), 5U);
  EXPECT_EQ(stability.sweeps[1].cells[1].value, 1.1);
  EXPECT_EQ(stability.sweeps[2].cells.size(), 2U) << "the exact surface and triangles";
  EXPECT_EQ(stability.totals().right, count_winner_cells(found));
  const Cell& first = stability.sweeps[0].cells[0];
  EXPECT_NE(first.errors.at(0).reference, 0.0);
  EXPECT_THAT(first.message, HasSubstr("homogeneity.h_rms of the winner"));
}

// Two designs that noise alone tells apart: another seed makes the other one better.
TEST(MeasureWinner, AWinnerByNoiseIsFoundOut) {
  const TemporaryFolder folder;
  const std::string noisy = "blur_px = 0\nfull_well_e = 300\nbits = 8";
  make_run(folder, noisy, {trial_at(1, {0.5, 90.0}, 0.6), trial_at(2, {0.5, 93.5}, 0.7)}, 2);
  const Stability stability =
      measure_winner(runners_up(folder.path()), {.threads = 2, .bounds = {.h_points = 1e-6}});
  const std::vector<Cell>& seeds = stability.sweeps[0].cells;
  EXPECT_TRUE(
      std::ranges::any_of(seeds, [](const Cell& cell) { return cell.verdict == Verdict::kWrong; }));
  const Stability lax =
      measure_winner(runners_up(folder.path()), {.threads = 2, .bounds = {.h_points = 20.0}});
  EXPECT_EQ(lax.totals().wrong, 0) << "less than the bound is no matter";
}

}  // namespace
}  // namespace glint::stability
