// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/budget_note.h"

#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/accuracy/unreached.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Rungs of 1, 4 and 16 with bounds of 0.3, 0.1 and 0.02; the dearest is taken.
ChosenAccuracy three_rungs() {
  ChosenAccuracy chosen;
  for (const auto& [name, work, bound] : {std::tuple{"coarse", 1.0, 0.3},
                                          std::tuple{"middle", 4.0, 0.1},
                                          std::tuple{"fine", 16.0, 0.02}}) {
    RenderRung rung;
    rung.name = name;
    rung.work = work;
    chosen.ladder.push_back(rung);
    StepReport step;
    step.bounds = {{.score = "homogeneity.h_rms", .bound = bound}};
    chosen.choice.steps.push_back(step);
  }
  chosen.choice.step = 2;
  return chosen;
}

Study study_of(int evaluations) {
  Study study;
  study.budget = {.evaluations = evaluations, .wall_clock_s = 60.0};
  return study;
}

// 30 evaluations of 16 are 120 of 4 and 480 of 1.
TEST(BudgetNote, TellsTheBoundThatIsToBeHadInTime) {
  const ChosenAccuracy chosen = three_rungs();
  EXPECT_THAT(budget_note(study_of(30), chosen, 30), IsEmpty());
  const std::string of_middle = budget_note(study_of(100), chosen, 30);
  EXPECT_THAT(of_middle, HasSubstr("by \"fine\" about 30 of 100 evaluations fit into 60 s"));
  EXPECT_THAT(of_middle,
              HasSubstr("by \"middle\", which is exact to homogeneity.h_rms within 0.1"));
  EXPECT_THAT(budget_note(study_of(400), chosen, 30), HasSubstr("by \"coarse\""));
  EXPECT_THAT(budget_note(study_of(500), chosen, 30), HasSubstr("no cheaper way"));
}

TEST(BudgetNote, WithoutANumberASearchOfSomeEvaluationsIsWanted) {
  const ChosenAccuracy chosen = three_rungs();
  EXPECT_THAT(budget_note(study_of(0), chosen, 20), IsEmpty());
  EXPECT_THAT(budget_note(study_of(0), chosen, 19), HasSubstr("19 of 20"));
}

TEST(BudgetNote, NamesNoRungThatWasNotTried) {
  ChosenAccuracy chosen = three_rungs();
  chosen.choice.steps[1].bounds.clear();
  EXPECT_THAT(budget_note(study_of(100), chosen, 30), HasSubstr("by \"coarse\""));
}

TEST(BudgetNote, NamesNoRungThatWasLeftOut) {
  ChosenAccuracy chosen = three_rungs();
  chosen.choice.steps[1].skipped = R"("middle" differs from "fine" by too much)";
  EXPECT_THAT(budget_note(study_of(100), chosen, 30), HasSubstr("by \"coarse\""));
}

/// Half of the designs each: by "middle" with bar, by "fine" with ring, 10 an evaluation.
ChosenAccuracy two_branches() {
  ChosenAccuracy chosen;
  chosen.split = split_by({{0, "lighting_use", {"bar", "ring"}}});
  for (std::size_t branch = 0; branch < 2; ++branch) {
    ChosenAccuracy part = three_rungs();
    part.label = chosen.split->label(branch);
    part.share = 0.5;
    chosen.branches.push_back(part);
  }
  chosen.branches[0].choice.step = 1;
  return chosen;
}

// 30 evaluations of 10 are 75 of 4 (both by "middle") and 120 of 2.5 (bar by "coarse"); of 1, the
// least, they are 300.
TEST(BudgetNote, OfBranchesTellsTheBoundsOfThoseThatGoDown) {
  const ChosenAccuracy chosen = two_branches();
  const std::string of_ring = budget_note(study_of(60), chosen, 30);
  EXPECT_THAT(of_ring, HasSubstr("by \"bar: middle; ring: fine\" about 30 of 60 evaluations"));
  EXPECT_THAT(
      of_ring,
      HasSubstr("all of them would by \"middle\" for lighting_use = ring, which is exact to "
                "homogeneity.h_rms within 0.1."));
  EXPECT_THAT(budget_note(study_of(100), chosen, 30),
              HasSubstr("by \"coarse\" for lighting_use = bar, which is exact to "
                        "homogeneity.h_rms within 0.3; and by \"middle\" for lighting_use = ring"));
  EXPECT_THAT(budget_note(study_of(301), chosen, 30), HasSubstr("no cheaper way"));
}

// Few reflections come near by chance in one score; they are left out for another one.
TEST(UnreachedTexts, NameNoStepThatWasLeftOut) {
  LadderTask task;
  task.wish.wishes = {{.score = "homogeneity.h_rms", .tolerance = 0.01}};
  LadderChoice choice = {.step = 1};
  for (const auto& [name, bound] : {std::pair{"direct", 0.02}, std::pair{"all", 0.05}}) {
    task.steps.push_back({.name = name, .work = 1.0});
    choice.steps.push_back({.is_tried = true});
    choice.steps.back().bounds = {
        {.score = "homogeneity.h_rms", .tolerance = 0.01, .bound = bound}};
  }
  EXPECT_THAT(unreached_texts(task, choice, false),
              testing::ElementsAre(HasSubstr("\"direct\" reaches 0.02")));
  choice.steps[0].skipped = R"("direct" differs from "all" by too much)";
  EXPECT_THAT(unreached_texts(task, choice, false),
              testing::ElementsAre(HasSubstr("\"all\" reaches 0.05")));
}

TEST(UnreachedTexts, SayThatTheTakenStepCannotRenderEveryDesign) {
  LadderTask task;
  task.wish.wishes = {{.score = "homogeneity.h_rms", .tolerance = 0.01}};
  task.steps = {{.name = "direct", .work = 1.0}, {.name = "all", .work = 2.0}};
  LadderChoice choice = {.step = 1};
  choice.steps = {{.is_tried = true}, {.is_tried = true}};
  choice.steps[0].bounds = {{.score = "homogeneity.h_rms", .tolerance = 0.01, .bound = 0.02}};
  const auto unable = HasSubstr("\"all\", which is taken, cannot render every design");
  EXPECT_THAT(unreached_texts(task, choice, false),
              testing::ElementsAre(HasSubstr("\"direct\" reaches 0.02"), unable));
  task.wish.is_auto = true;
  EXPECT_THAT(unreached_texts(task, choice, false), testing::ElementsAre(unable));
}

}  // namespace
}  // namespace glint
