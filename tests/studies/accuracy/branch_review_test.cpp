// SPDX-License-Identifier: GPL-3.0-or-later
//
// A search of two kinds of light whose ring turns out to be rendered too coarsely, with evaluations
// that are made up: 8 samples of it are wrong by 1 for all designs that the trial did not have.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/accuracy/accurate_search.h"
#include "studies/accuracy/outcome_labels.h"
#include "studies/accuracy/tried_designs.h"
#include "tests/studies/accuracy/branch_study.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using test::kRingBranch;
using test::kTunnelBranch;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr const char* kCoarseRing = "direct light, 8 samples";
constexpr const char* kFineRing = "direct light, 16 samples";

struct BranchedRun {
  SearchResult search;
  AccurateSearch found;
  nlohmann::ordered_json check;
  int evaluations = 0;                    ///< in this process, of search and trial
  std::map<std::string, int> of_tunnels;  ///< how often each was evaluated at each rung
};

std::set<double> gains_of_trial(const Study& study) {
  std::set<double> gains;
  for (const TrialDesigns& designs : tried_designs(study, *branch_split(study))) {
    for (const TriedDesign& design : designs.candidates) {
      gains.insert(test::branch_design(design.overrides).gain);
    }
  }
  return gains;
}

/// Rings are better than tunnels, the best at a gain of 1.7.
double made_up_score(const test::BranchDesign& design) {
  return design.is_ring ? 1.0 - std::pow(design.gain - 1.7, 2) / 4.0
                        : 0.3 - std::pow(design.gain - 1.0, 2) / 4.0;
}

struct BranchedRunOptions {
  int stop_at = 0;           ///< the evaluation that an interrupt cuts short; 0: none
  bool is_fine_able = true;  ///< false: the finer rung of rings cannot render the trial's designs
};

/// @param is_tried  the trial has a design of its gain
Outcome made_up_outcome(const test::BranchDesign& design,
                        const RenderRung& rung,
                        bool is_tried,
                        const BranchedRunOptions& options) {
  if (design.is_ring && rung.name == kFineRing && is_tried && !options.is_fine_able) {
    return Outcome{.is_failed = true, .message = "cannot be rendered"};
  }
  const bool is_wrong = design.is_ring && rung.name == kCoarseRing && !is_tried;
  return Outcome{.scores = test::branch_scores(made_up_score(design) + (is_wrong ? 1.0 : 0.0))};
}

BranchedRun branched_run_in(const TemporaryFolder& folder, const BranchedRunOptions& options = {}) {
  write_file(folder / "study.toml",
             test::branch_study("tolerance = { \"homogeneity.mean\" = 0.2 }"));
  const Study study = load_study(folder / "study.toml", {});
  const std::set<double> tried = gains_of_trial(study);
  ThreadPool pool(1);
  SceneStore store(pool);
  const StudyIdentity identity = {.config_hash = "abc", .config_text = "", .code_version = "test"};
  Storage storage = Storage::open(folder / "study.sqlite", identity);
  Storage record = Storage::open(folder / "accuracy.sqlite", identity);
  std::atomic<int> interrupt = 0;
  BranchedRun run;
  const auto evaluate = [&](const Overrides& overrides, const RenderRung& rung) {
    if (++run.evaluations == options.stop_at) {
      interrupt = 2;
      throw EvaluationAborted();
    }
    const test::BranchDesign design = test::branch_design(overrides);
    if (!design.is_ring) {
      ++run.of_tunnels[fmt::format("{} {:a}", rung.name, design.gain)];
    }
    return made_up_outcome(design, rung, tried.contains(design.gain), options);
  };
  const auto search = [&](const ChosenAccuracy& chosen, const Review& review) {
    return run_search(
        {.space = study.space,
         .settings = study.search,
         .goal = study.goal,
         .budget = study.budget,
         .start_points = {baseline_point(study)},
         .review = review,
         .label =
             [&](const Point& point) {
               return searched_label(study, chosen.of(point).rung().name);
             }},
        storage,
        [&](const Point& point, int) {
          const ChosenAccuracy& part = chosen.of(point);
          const auto known = part.known.find(point);
          return known != part.known.end() ? known->second
                                           : evaluate(overrides_of(study, point), part.rung());
        },
        &interrupt);
  };
  run.search = search_accurately({.study = study,
                                  .store = store,
                                  .record = &record,
                                  .interrupt = &interrupt,
                                  .evaluate = evaluate},
                                 storage,
                                 search,
                                 run.found);
  if (run.found.check) {
    run.check = check_json(*run.found.chosen, *run.found.check, run.search.evaluations);
  }
  return run;
}

std::string branched_trials_of(const TemporaryFolder& folder) {
  std::string text;
  for (const Trial& trial : Storage::read(folder / "study.sqlite").trials(TrialKind::kSearch)) {
    text += fmt::format("{} {:a}", trial.number, fmt::join(trial.point, " "));
    text += trial.outcome ? fmt::format(" {:a}\n", trial.outcome->scores.at(test::kBranchScore))
                          : " -\n";
  }
  return text;
}

TEST(BranchReview, RaisesTheRungOfTheBranchThatIsBeyondItsBound) {
  const TemporaryFolder folder;
  const BranchedRun run = branched_run_in(folder);
  ASSERT_TRUE(run.found.check);
  ASSERT_THAT(run.found.check->ended, SizeIs(1));
  const EndedEpoch& ended = run.found.check->ended[0];
  EXPECT_EQ(ended.rung, kCoarseRing);
  EXPECT_GE(ended.evaluations, kUncheckedEvaluations) << "of the ring";
  EXPECT_THAT(ended.sentence,
              AllOf(HasSubstr(" designs of these branches evaluated so far were evaluated again"),
                    HasSubstr("\"direct light, 16 samples\" (lighting_use = ring)"),
                    Not(HasSubstr("tunnel"))));
  const ChosenAccuracy& chosen = *run.found.chosen;
  EXPECT_EQ(chosen.branches[kRingBranch].rung().name, kFineRing);
  EXPECT_EQ(chosen.branches[kTunnelBranch].choice.step, 0U);
  // No score of the coarse rung is left.
  for (const Trial& trial : Storage::read(folder / "study.sqlite").trials(TrialKind::kSearch)) {
    EXPECT_LE(trial.outcome->scores.at(test::kBranchScore), 1.0) << trial.number;
  }
  EXPECT_EQ(chosen.index_of(run.search.best->point), kRingBranch);
}

TEST(BranchReview, DesignsOfOtherBranchesAreNotEvaluatedAgain) {
  const TemporaryFolder folder;
  const BranchedRun run = branched_run_in(folder);
  ASSERT_THAT(run.found.check->ended, SizeIs(1));
  const std::string rung = run.found.chosen->branches[kTunnelBranch].rung().name + " ";
  int designs = 0;
  for (const auto& [design, count] : run.of_tunnels) {
    if (design.starts_with(rung)) {
      EXPECT_EQ(count, 1) << design;
      ++designs;
    }
  }
  EXPECT_GT(designs, 20);
}

// Its own designs at the rung that was left, and those of each branch at its last one.
TEST(BranchReview, OutcomesAreKeptByTheRungOfTheirBranch) {
  const TemporaryFolder folder;
  const BranchedRun run = branched_run_in(folder);
  ASSERT_THAT(run.found.check->ended, SizeIs(1));
  const Storage storage = Storage::read(folder / "study.sqlite");
  std::map<std::string, int> outcomes;
  for (const Replicate& replicate : storage.replicates(TrialKind::kSearch)) {
    ++outcomes[replicate.rung];
  }
  int rings = 0;
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    rings += run.found.chosen->index_of(trial.point) == kRingBranch ? 1 : 0;
  }
  const std::string tunnel = run.found.chosen->branches[kTunnelBranch].rung().name;
  EXPECT_EQ(outcomes.at(kCoarseRing), run.found.check->ended[0].evaluations);
  EXPECT_EQ(outcomes.at(kFineRing), rings);
  EXPECT_EQ(outcomes.at(tunnel), run.search.evaluations - rings);
}

TEST(BranchReview, ChecksCompareWithinTheBranch) {
  const TemporaryFolder folder;
  const BranchedRun run = branched_run_in(folder);
  ASSERT_TRUE(run.found.check);
  const ChosenAccuracy& chosen = *run.found.chosen;
  ASSERT_FALSE(run.found.check->designs.empty());
  for (const auto* designs : {&run.found.check->during, &run.found.check->designs}) {
    for (const CheckedDesign& design : *designs) {
      const std::vector<RenderRung>& ladder = chosen.branches[design.branch].ladder;
      EXPECT_TRUE(std::ranges::find(ladder, design.rung, &RenderRung::name) != ladder.end())
          << design.rung;
      EXPECT_TRUE(design.beyond.empty()) << design.trial;
    }
  }
  EXPECT_LE(run.check["share"].get<double>(), kCheckShare);
  for (const auto& design : run.check["designs"]) {
    const Trial& best = *run.search.best;
    if (design["trial"] == best.number) {
      EXPECT_EQ(design["branch"], "ring");
    }
  }
}

TEST(BranchReview, CutShortItComesToTheSame) {
  const TemporaryFolder whole;
  const BranchedRun expected = branched_run_in(whole);
  for (const int stop_at : {expected.evaluations / 8,
                            expected.evaluations / 2,
                            expected.evaluations * 3 / 4,
                            expected.evaluations - 2}) {
    const TemporaryFolder folder;
    EXPECT_EQ(branched_run_in(folder, {.stop_at = stop_at}).search.termination,
              Termination::kInterrupted);
    const BranchedRun run = branched_run_in(folder);
    EXPECT_EQ(branched_trials_of(folder), branched_trials_of(whole)) << stop_at;
    EXPECT_EQ(run.check, expected.check) << stop_at;
  }
}

// An epoch would evaluate all rings again by what bounds nothing.
TEST(BranchReview, ABranchStaysWhereNoDearerRungRendersTheTrialsDesigns) {
  const TemporaryFolder folder;
  const BranchedRun run = branched_run_in(folder, {.is_fine_able = false});
  ASSERT_TRUE(run.found.check);
  EXPECT_THAT(run.found.check->ended, IsEmpty());
  const ChosenAccuracy& ring = run.found.chosen->branches[kRingBranch];
  EXPECT_EQ(ring.rung().name, kCoarseRing);
  EXPECT_THAT(ring.stays,
              AllOf(HasSubstr("the branch of lighting_use = ring stays at the former"),
                    HasSubstr("(\"direct light, 16 samples\") renders every design")));
  int beyond = 0;
  for (const CheckedDesign& design : run.found.check->during) {
    beyond += design.beyond.empty() ? 0 : 1;
  }
  EXPECT_GE(beyond, 1) << "it is told";
}

TEST(BranchReview, CutShortWhereItStaysItComesToTheSame) {
  const BranchedRunOptions unable = {.is_fine_able = false};
  const TemporaryFolder whole;
  const BranchedRun expected = branched_run_in(whole, unable);
  const TemporaryFolder folder;
  const int late = expected.evaluations - 20;
  branched_run_in(folder, {.stop_at = late, .is_fine_able = false});
  const BranchedRun run = branched_run_in(folder, unable);
  EXPECT_EQ(branched_trials_of(folder), branched_trials_of(whole));
  EXPECT_EQ(run.check, expected.check);
  EXPECT_EQ(run.found.chosen->branches[kRingBranch].stays,
            expected.found.chosen->branches[kRingBranch].stays);
}

TEST(BranchReview, TheRecordHasTheRungsOfAllBranches) {
  const TemporaryFolder folder;
  branched_run_in(folder, {.stop_at = 60});
  const std::vector<Event> events = Storage::read(folder / "accuracy.sqlite").events();
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(events[0].kind, EventKind::kRules);
  EXPECT_EQ(events[0].value, kBranchRules);
  EXPECT_THAT(events[0].text,
              AllOf(HasSubstr("tunnel: "), HasSubstr("; ring: direct light, 8 samples")));
}

}  // namespace
}  // namespace glint
