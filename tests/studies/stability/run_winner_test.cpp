// SPDX-License-Identifier: GPL-3.0-or-later
//
// The stability of a winner, of runs whose folders are made up: three designs of a small tunnel.
#include "studies/stability/run_winner.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "optimizer/storage/storage.h"
#include "studies/stability/stability_page.h"
#include "tests/studies/run/small_tunnel.h"
#include "tests/support/temporary_folder.h"

namespace glint::stability {
namespace {

using ::testing::HasSubstr;

std::string small_study(const std::string& sensor) {
  return test::kSmallTunnel + R"([variables]
"lighting.tunnel.duty" = { min = 0.3, max = 0.7 }
"lighting.tunnel.period_mm" = { min = 6, max = 30 }
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
  write_file(folder / "result.json", R"({"best": {"trial": )" + std::to_string(best) + "}}\n");
  Storage storage = Storage::open(folder / "study.sqlite", {.config_hash = "test"});
  for (const Trial& trial : trials) {
    storage.put_trial(trial);
  }
}

const Point kDark = {0.35, 10.0};
const Point kBright = {0.5, 24.0};

TEST(RunnersUp, LeaveOutDesignsThatAreTheWinnerButForDigits) {
  const TemporaryFolder folder;
  make_run(folder,
           "blur_px = 0",
           {trial_at(1, kDark, 0.5),
            trial_at(2, kBright, 0.9),
            trial_at(3, {0.501, 24.0}, 0.89),
            trial_at(4, {0.62, 24.0}, 0.7)},
           2);
  const RunnersUp found = runners_up(folder.path());
  EXPECT_EQ(found.winner_trial, 2);
  EXPECT_EQ(found.winner, kBright);
  EXPECT_EQ(found.second_trial, 4) << "3 is 0.0025 of a range away";
}

TEST(RunnersUp, OfAllDesignsNearTheWinnerTheNextBestIsTaken) {
  const TemporaryFolder folder;
  make_run(folder, "blur_px = 0", {trial_at(1, kBright, 0.9), trial_at(2, {0.501, 24.0}, 0.8)}, 1);
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

// h of stripes of 10 and 6 mm at a duty of 0.62: 63.21 and 62.91 points without blur, 63.29
// and 63.08 at 0.1 px, 63.73 and 63.76 at 0.2 px: the order turns round by 0.03 points.
TEST(MeasureWinner, AWinnerThatSomeBlurTurnsRoundIsFoundOut) {
  const TemporaryFolder folder;
  make_run(folder, "blur_px = 0", {trial_at(1, {0.62, 6}, 0.62), trial_at(2, {0.62, 10}, 0.63)}, 2);
  const RunnersUp found = runners_up(folder.path());
  const Stability strict = measure_winner(found, {.threads = 2, .bounds = {.h_points = 1e-3}});
  const std::vector<Cell>& blurs = strict.sweeps[1].cells;
  ASSERT_EQ(blurs.size(), 3U);
  EXPECT_EQ(blurs[1].verdict, Verdict::kRight);
  EXPECT_EQ(blurs[2].verdict, Verdict::kWrong);
  EXPECT_NEAR(blurs[2].errors.at(0).error, 0.035, 0.005);
  EXPECT_LT(blurs[2].errors.at(0).measured, 0.0);
  const Stability usual = measure_winner(found, {.threads = 2});
  EXPECT_EQ(usual.totals().wrong, 0) << "less than half a point is no matter";
}

// A run's own study lies in each run under the same name.
TEST(WinnerStudy, OfAnotherStudyIsNotReplaced) {
  const TemporaryFolder folder;
  make_run(folder, "blur_px = 1", {trial_at(1, kDark, 0.5), trial_at(2, kBright, 0.9)}, 2);
  write_file(folder / "run.json", R"({"verb": "run", "study": "gear"})");
  const StabilityRun run = {.out = folder / "out", .progress = Progress::Style::kNone};
  std::filesystem::create_directory(run.out);
  write_file(run.out / "run.json", R"({"verb": "stability", "study": "shaft"})");
  EXPECT_THAT([&] { winner_study(folder.path(), run); },
              ::testing::ThrowsMessage<ConfigError>(
                  HasSubstr("holds results of `glint stability` of shaft")));
  write_file(run.out / "run.json", R"({"verb": "stability", "study": "gear"})");
  EXPECT_EQ(winner_study(folder.path(), run)["totals"]["silently_wrong"], 0);
  EXPECT_THAT(read_file(run.out / "run.json"), HasSubstr("\"study\": \"gear\""));
}

}  // namespace
}  // namespace glint::stability
