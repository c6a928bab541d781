// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/search_frontier.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "optimizer/storage/storage.h"
#include "studies/frontier/search_page.h"
#include "tests/studies/run/small_tunnel.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Study tunnel_study(const TemporaryFolder& folder, const std::vector<KeyValue>& sets = {}) {
  write_file(folder / "study.toml", test::kSmallTunnelStudy + "evaluations = 12\n");
  return load_study(folder / "study.toml", sets);
}

SearchFrontier searched(const Study& study,
                        const std::filesystem::path& folder,
                        double budget_s,
                        const std::vector<std::string>& methods = {"random", "sbplx"}) {
  std::filesystem::create_directories(folder);
  return measure_searches(
      study,
      {.folder = folder, .methods = methods, .seeds = 3, .threads = 2, .budget_s = budget_s});
}

TEST(CheckpointsTo, AreOneTwoFiveOfEachPowerAndTheLast) {
  EXPECT_THAT(checkpoints_to(50), ElementsAre(1, 2, 5, 10, 20, 50));
  EXPECT_THAT(checkpoints_to(12), ElementsAre(1, 2, 5, 10, 12));
  EXPECT_THAT(checkpoints_to(1), ElementsAre(1));
}

// Of four winners 0.2, 0.6, 0.4 and one that is not feasible: median 0.4. Two came to the second
// step: median (0.5 + 0.9) / 2.
TEST(SummaryOf, IsOverFeasibleWinnersThatWereScoredAgain) {
  const auto run = [](std::vector<SearchStep> steps) {
    return SearchRun{.seed = 1, .evaluations = 2, .is_whole = true, .steps = std::move(steps)};
  };
  const auto step = [](int count, double top, bool is_feasible = true) {
    return SearchStep{.evaluations = count, .score = 7.0, .top = top, .is_feasible = is_feasible};
  };
  const auto list = summary_of({run({step(1, 0.2), step(2, 0.5)}),
                                run({step(1, 0.6), step(2, 0.9)}),
                                run({step(1, 0.4)}),
                                run({step(1, 99.0, false)})});
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].runs, 4);
  EXPECT_EQ(list[0].feasible, 3);
  EXPECT_DOUBLE_EQ(*list[0].median, 0.4);
  EXPECT_DOUBLE_EQ(*list[0].low, 0.2);
  EXPECT_DOUBLE_EQ(*list[0].high, 0.6);
  EXPECT_DOUBLE_EQ(*list[1].median, 0.7);
}

TEST(MeasureSearches, WinnersGetBetterWithEvaluations) {
  const TemporaryFolder folder;
  const SearchFrontier frontier = searched(tunnel_study(folder), folder / "s", 600.0);
  EXPECT_TRUE(frontier.is_whole);
  ASSERT_EQ(frontier.methods.size(), 2U);
  for (const SearchedMethod& method : frontier.methods) {
    ASSERT_EQ(method.runs.size(), 3U) << method.problem;
    for (const SearchRun& run : method.runs) {
      ASSERT_EQ(run.steps.size(), 5U);
      for (std::size_t k = 1; k < run.steps.size(); ++k) {
        EXPECT_GE(*run.steps[k].score, *run.steps[k - 1].score);
        EXPECT_TRUE(run.steps[k].top);
      }
    }
  }
  const std::vector<SearchRun>& random = frontier.methods[0].runs;
  EXPECT_EQ(random[0].steps[0].top, random[1].steps[0].top) << "all begin with the baseline";
  const auto second = [&](const char* database) {
    return Storage::read(folder / "s" / database).trials(TrialKind::kSearch).at(1).point;
  };
  EXPECT_NE(second("random_1.sqlite"), second("random_2.sqlite")) << "seeds differ";
}

TEST(MeasureSearches, GoesOnWithWhatTheBudgetCut) {
  const TemporaryFolder folder;
  const Study study = tunnel_study(folder);
  const SearchFrontier cut = searched(study, folder / "cut", 1e-9);
  EXPECT_FALSE(cut.is_whole);
  EXPECT_LT(cut.methods[0].runs[0].evaluations, 12);
  const SearchFrontier whole = searched(study, folder / "whole", 600.0);
  const SearchFrontier resumed = searched(study, folder / "cut", 600.0);
  EXPECT_TRUE(resumed.is_whole);
  EXPECT_EQ(searches_json(study, resumed), searches_json(study, whole));
}

// As earlier programs, which counted prototypes; the title is counted by all.
TEST(MeasureSearches, GoesOnWithAFolderThatKnowsTheStudyByAnotherHash) {
  const TemporaryFolder folder;
  searched(tunnel_study(folder, {{"title", "\"Once\""}}), folder / "s", 600.0, {"random"});
  const Study renamed = tunnel_study(folder, {{"title", "\"Now\""}});
  const SearchFrontier again = searched(renamed, folder / "s", 600.0, {"random"});
  EXPECT_EQ(again.methods[0].problem, "");
  EXPECT_EQ(again.methods[0].runs.size(), 3U);
}

TEST(MeasureSearches, RefusesWhatHasNoSearchAndNamesMethodsThatCannot) {
  const TemporaryFolder folder;
  try {
    searched(tunnel_study(folder, {{"variables", "{}"}}), folder / "none", 1.0);
    FAIL() << "there is nothing to search";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a search chart needs [variables] and [objective]"));
  }
  const SearchFrontier frontier =
      searched(tunnel_study(folder), folder / "s", 600.0, {"no_such_method", "random"});
  EXPECT_THAT(frontier.methods[0].problem, HasSubstr("no_such_method"));
  EXPECT_EQ(frontier.methods[1].runs.size(), 3U);
}

}  // namespace
}  // namespace glint
