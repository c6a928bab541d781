// SPDX-License-Identifier: GPL-3.0-or-later
//
// [objective], [[objective]] and [choice].
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "studies/definition/study.h"
#include "studies/definition/study_text.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

Study goal_study(const std::string& text, const std::vector<KeyValue>& sets = {}) {
  const TemporaryFolder folder;
  write_file(folder / "s.toml", text);
  return load_study(folder / "s.toml", sets);
}

std::string goal_error(const std::string& text, const std::vector<KeyValue>& sets = {}) {
  try {
    goal_study(text, sets);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

const std::string kScene =
    "[lighting.tunnel]\n[defects.dent]\nx_mm = [5]\ny_mm = [10]\n"
    "[variables]\n\"lighting.tunnel.duty\" = { min = 0.3, max = 0.7 }\n";

const std::string kEven = "[[objective]]\nmaximise = \"homogeneity.h_rms\"\n";
const std::string kVisible = "[[objective]]\nmaximise = \"defects.min_cnr\"\n";

TEST(StudyGoal, ReadsSeveralObjectivesAndTheChoice) {
  const Study study =
      goal_study(kScene + kEven + "reference = 0.2\naspiration = 0.8\nweight = 2\n" + kVisible +
                 "[choice]\nby = \"aspirations\"\n");
  const std::vector<Objective> objectives = objectives_of(study.goal);
  ASSERT_EQ(objectives.size(), 2U);
  EXPECT_EQ(objectives[0].name, "homogeneity.h_rms");
  EXPECT_TRUE(objectives[0].is_maximised);
  EXPECT_EQ(objectives[0].reference, 0.2);
  EXPECT_EQ(objectives[0].aspiration, 0.8);
  EXPECT_EQ(objectives[0].weight, 2.0);
  EXPECT_EQ(objectives[1].name, "defects.min_cnr");
  EXPECT_FALSE(objectives[1].reference.has_value());
  EXPECT_EQ(study.goal.choice, ChoiceRule::kAspirations);
  // An evenly white picture wins nothing; how well the defects show is an objective itself.
  ASSERT_EQ(study.goal.constraints.size(), 1U);
  EXPECT_EQ(study.goal.constraints[0].name, "homogeneity.clipped_share");
}

TEST(StudyGoal, TheResolvedTextIsTheSameStudyWithSeveralObjectives) {
  const TemporaryFolder folder;
  write_file(folder / "s.toml",
             kScene + kEven + "weight = 2\n" + kVisible + "[choice]\nby = \"weights\"\n");
  const Study study = load_study(folder / "s.toml", {});
  write_file(folder / "again.toml", resolved_text(study));
  const Study again = load_study(folder / "again.toml", {});
  EXPECT_EQ(resolved_text(again), resolved_text(study));
  EXPECT_EQ(num_objectives(again.goal), 2);
  EXPECT_EQ(again.goal.choice, ChoiceRule::kWeights);
  EXPECT_FALSE(has_several_objectives(scene_study(study).goal));
  EXPECT_EQ(scene_study(study).root.find("choice"), nullptr);
}

TEST(StudyGoal, RefusesWhatSeveralObjectivesDoNotGoWith) {
  const std::string both = kScene + kEven + kVisible;
  EXPECT_EQ(goal_error(both), "");
  EXPECT_THAT(
      goal_error(both, {{"budget.target", "3"}}),
      HasSubstr("budget.target: works with a single objective only, this study has several; "
                "allowed: budget.stall"));
  EXPECT_THAT(
      goal_error(both, {{"search.algorithm", "sbplx"}}),
      HasSubstr("search.algorithm: \"sbplx\" works with a single objective only, this study "
                "has 2; allowed: \"auto\", \"gp\", \"nsga2\", \"nspso\", \"sobol\", \"random\""));
  EXPECT_EQ(goal_error(both, {{"search.algorithm", "nsga2"}}), "");
  EXPECT_THAT(goal_error(kScene + "[objective]\nmaximise = \"homogeneity.h_rms\"\n",
                         {{"search.algorithm", "nspso"}}),
              HasSubstr("search.algorithm: \"nspso\" needs several objectives, there is one"));
  EXPECT_EQ(goal_error(both + "[manufacture]\n\"lighting.tunnel.duty\" = { plus_minus = 0.01 }\n"),
            "");
  EXPECT_THAT(goal_error(both + "[prototypes.front]\n\"lighting.tunnel.duty\" = 0.4\n"),
              HasSubstr("prototypes.front: the folder front/ of a run holds the designs"));
  EXPECT_THAT(goal_error("[defects.dent]\nx_mm = [5]\ny_mm = [10]\n" + kEven + kVisible),
              HasSubstr("objective: several objectives need [variables]"));
}

TEST(StudyGoal, RefusesContradictionsInOneLineEach) {
  const auto refused = [](const std::string& goal, const std::string& text) {
    const std::string error = goal_error(kScene + goal);
    EXPECT_THAT(error, HasSubstr(text));
    EXPECT_EQ(std::ranges::count(error, '\n'), 0) << error;
    EXPECT_THAT(error, HasSubstr("s.toml:")) << "has a place";
  };
  refused(kEven + kEven, "\"homogeneity.h_rms\" is an objective twice");
  refused(kEven, "objective: [[objective]] is for several, there is one");
  refused(kEven + "[[objective]]\nmaximise = \"defects.min_crn\"\n",
          "objective.1.maximise: \"defects.min_crn\"");
  refused(kEven + "[[objective]]\nreference = 3\n", "objective.1: needs maximise or minimise");
  refused(kEven + kVisible + "wieght = 3\n", "objective.1.wieght: must be one maximise");
  refused(kEven + kVisible + "weight = 0\n", "objective.1.weight: must be");
  refused(kEven + kVisible + "reference = 5\naspiration = 3\n",
          "defects.min_cnr: aspiration 3 must be above the reference 5");
  refused(kEven + kVisible + "[choice]\nby = \"aspirations\"\n",
          "choice.by: \"aspirations\" needs an objective with an aspiration");
  refused(kEven + kVisible + "[choice]\nby = \"hope\"\n", "choice.by: ");
  refused("[objective]\nmaximize = \"homogeneity.h_rms\"\n",
          "objective: must hold either maximise or minimise = \"name of a score\"; it holds "
          "\"maximize\"");
  refused("[objective]\nmaximise = \"homogeneity.h_rms\"\n[choice]\nby = \"knee\"\n",
          "choice: chooses between several objectives");
}

/// Hashes of studies with one objective are those of earlier programs.
TEST(StudyGoal, OneObjectiveIsWrittenAsBefore) {
  const Study study = goal_study(kScene + "[objective]\nmaximise = \"homogeneity.h_rms\"\n");
  const std::string text = resolved_text(study);
  EXPECT_THAT(text, HasSubstr("[objective]\nmaximise = "));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("choice]")));
  EXPECT_EQ(num_objectives(study.goal), 1);
}

}  // namespace
}  // namespace glint
