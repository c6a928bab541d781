// SPDX-License-Identifier: GPL-3.0-or-later
//
// Half resolution as the rung of one branch of two, with evaluations that are made up: it is too
// bright by 0.5, and off by 0.01 either way beside that.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/accuracy/accuracy_report.h"
#include "studies/accuracy/chosen_accuracy.h"
#include "studies/accuracy/search_review.h"
#include "tests/studies/accuracy/branch_study.h"
#include "tests/support/temporary_folder.h"

namespace glint::half_resolution_branch_test {
namespace {

using test::kBranchScore;
using test::kRingBranch;
using test::kTunnelBranch;
using ::testing::HasSubstr;

constexpr double kTooBright = 0.5;
constexpr double kScatter = 0.01;
constexpr const char* kHalfRung = "half resolution, direct light, 8 samples";

Outcome half_made_up(const Overrides& overrides, const RenderRung& rung) {
  const test::BranchDesign design = test::branch_design(overrides);
  const bool is_half = design.is_ring && rung.pixel_factor > 1;
  const double error = kTooBright + kScatter * test::branch_sign(design.gain);
  return Outcome{.scores = test::branch_scores(design.gain + (is_half ? error : 0.0))};
}

/// Pictures of 96 x 72 pixels are large enough for it.
struct Chosen {
  Chosen() {
    write_file(folder / "study.toml",
               test::branch_study("tolerance = { \"homogeneity.mean\" = 0.2 }"));
    study =
        load_study(folder / "study.toml", {{"camera.width_px", "96"}, {"camera.height_px", "72"}});
    chosen = choose_accuracy(task(), record);
  }

  AccuracyTask task() { return {.study = study, .store = store, .evaluate = half_made_up}; }

  TemporaryFolder folder;
  ThreadPool pool{1};
  SceneStore store{pool};
  AccuracyRecord record{nullptr};
  Study study;
  ChosenAccuracy chosen;
};

Trial trial_of(int number, const Point& point, double score) {
  return {.number = number,
          .name = {},
          .point = point,
          .outcome = Outcome{.scores = test::branch_scores(score)}};
}

// Its bound is that of what is left: at most 3.72 spreads of 0.0107, far below 0.2; with the mean
// error it would be 0.5 and more.
TEST(HalfResolutionBranch, ServesLessItsMeanErrorOverTheDesignsOfTheBranch) {
  const Chosen found;
  ASSERT_EQ(found.chosen.branches.size(), 2U);
  const ChosenAccuracy& ring = found.chosen.branches[kRingBranch];
  ASSERT_EQ(ring.rung().name, kHalfRung);
  EXPECT_TRUE(ring.choice.is_reached);
  EXPECT_LT(ring.choice.steps[ring.choice.step].bounds[0].bound, 0.05);
  EXPECT_NEAR(ring.rung().offsets.at(kBranchScore), kTooBright, kScatter);
  EXPECT_TRUE(found.chosen.branches[kTunnelBranch].rung().offsets.empty());
}

TEST(HalfResolutionBranch, ScoresOfItsDesignsAloneAreCorrected) {
  const Chosen found;
  double sum = 0.0;
  for (const auto& [point, outcome] : found.chosen.branches[kRingBranch].known) {
    const double error = outcome.scores.at(kBranchScore) - point[1];  // its gain
    EXPECT_LE(std::abs(error), 2.0 * kScatter + 1e-12);
    sum += error;
  }
  EXPECT_NEAR(sum, 0.0, 1e-12);
  for (const auto& [point, outcome] : found.chosen.branches[kTunnelBranch].known) {
    EXPECT_NEAR(outcome.scores.at(kBranchScore), point[1], 1e-12);
  }
}

TEST(HalfResolutionBranch, IsCheckedByAllPixelsOfItsBranch) {
  const Chosen found;
  const ChosenAccuracy& ring = found.chosen.branches[kRingBranch];
  const RenderRung* second = second_rung(ring);
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(second->name, "direct light, 8 samples");
  const Outcome dearer{.scores = test::branch_scores(1.0)};
  EXPECT_TRUE(compared(ring, trial_of(1, {1.0, 1.0}, 1.01), true, *second, dearer).beyond.empty());
  EXPECT_FALSE(compared(ring, trial_of(1, {1.0, 1.0}, 1.5), true, *second, dearer).beyond.empty())
      << "as if its mean error were still in it";
}

// The tunnel's rung rises: rings keep their scores less the mean error, which stays as it was.
TEST(HalfResolutionBranch, KeepsItsCorrectionWhereAnotherBranchRises) {
  Chosen found;
  const Trial tunnel = trial_of(1, {0.0, 1.234}, 9.0);
  const Trial ring = trial_of(2, {1.0, 1.111}, 1.12);
  const auto raised =
      raise_accuracy(found.task(), found.record, found.chosen, tunnel, std::vector{tunnel, ring});
  ASSERT_TRUE(raised.has_value());
  EXPECT_GT(raised->branches[kTunnelBranch].choice.step,
            found.chosen.branches[kTunnelBranch].choice.step);
  const ChosenAccuracy& part = raised->branches[kRingBranch];
  EXPECT_EQ(part.rung().name, kHalfRung);
  EXPECT_EQ(part.rung().offsets, found.chosen.branches[kRingBranch].rung().offsets);
  EXPECT_EQ(part.known.at(ring.point).scores, ring.outcome->scores);
}

// What a check knows of a ring at all pixels is taken as it is: nothing is taken out of it.
TEST(HalfResolutionBranch, LeavesTheCorrectionBehindWhereItsOwnRungRises) {
  Chosen found;
  const Trial ring = trial_of(2, {1.0, 1.111}, 1.9);
  found.record.keep("direct light, 8 samples",
                    trial_name(ring.number),
                    ring.point,
                    Outcome{.scores = test::branch_scores(1.111)});
  const auto raised =
      raise_accuracy(found.task(), found.record, found.chosen, ring, std::vector{ring});
  ASSERT_TRUE(raised.has_value());
  const ChosenAccuracy& part = raised->branches[kRingBranch];
  EXPECT_EQ(part.rung().name, "direct light, 8 samples");
  EXPECT_TRUE(part.rung().offsets.empty());
  EXPECT_EQ(part.known.at(ring.point).scores.at(kBranchScore), 1.111);
}

TEST(HalfResolutionBranch, IsReadBackWithItsCorrection) {
  const Chosen found;
  const auto told = accuracy_json(found.study, found.chosen, 90, {});
  EXPECT_EQ(told["branches"][1]["settings"]["resolution"], "half");
  EXPECT_EQ(told["branches"][0].count("offsets"), 0U);
  EXPECT_THAT(told["sentence"].get<std::string>(),
              HasSubstr("Of lighting_use = ring: Scores of half resolution are corrected"));
  write_file(found.folder / "result.json", nlohmann::ordered_json{{"accuracy", told}}.dump());
  const std::optional<SearchRungs> read = rungs_of_run(found.study, found.folder.path());
  ASSERT_TRUE(read.has_value());
  EXPECT_TRUE(read->rungs[kTunnelBranch].offsets.empty());
  EXPECT_EQ(read->rungs[kRingBranch].offsets, found.chosen.branches[kRingBranch].rung().offsets);
}

}  // namespace
}  // namespace glint::half_resolution_branch_test
