// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/warm_start.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "optimizer/storage/sqlite.h"
#include "studies/run/run.h"
#include "studies/run/study_search.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/studies/run/rendered_plate.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

const std::string kFirst = "schema = 1\ntitle = \"Plate\"\n" + kPathPlate + kPathRing + R"(
[variables]
"lighting.ring.height_mm" = { min = 20, max = 40 }
"lighting.ring.radiance.0" = { min = 0.1, max = 0.2 }
[objective]
maximise = "defects.min_weber"
[search]
algorithm = "gp"
[budget]
evaluations = 12
)";

/// A wider range, another seed and a larger budget.
const std::string kWider = replaced(
    replaced(replaced(kFirst, "max = 40", "max = 60"), "evaluations = 12", "evaluations = 20"),
    "algorithm = \"gp\"",
    "algorithm = \"gp\"\nseed = 5");

Study study_from_text(const TemporaryFolder& folder, const std::string& text) {
  write_file(folder / "study.toml", text);
  return load_study(folder / "study.toml", {});
}

std::filesystem::path run_into(const TemporaryFolder& folder,
                               const std::string& text,
                               const std::string& name,
                               const std::filesystem::path& from = {}) {
  run_study(study_from_text(folder, text),
            {.out = folder / name,
             .threads = 2,
             .jobs = 2,
             .progress = Progress::Style::kNone,
             .log_file = {},
             .from = from});
  return folder / name;
}

/// The folder of a run of kFirst, a copy of one that is made once.
std::filesystem::path first_in(const TemporaryFolder& folder, const std::string& name = "first") {
  static const TemporaryFolder made;
  if (!std::filesystem::exists(made / "first")) {
    run_into(made, kFirst, "first");
  }
  std::filesystem::copy(made / "first", folder / name, std::filesystem::copy_options::recursive);
  return folder / name;
}

std::vector<Trial> trials_of(const std::filesystem::path& run) {
  return Storage::read(run / "study.sqlite").trials(TrialKind::kSearch);
}

TEST(WarmStart, BeginsWithTheTrialsAndResumesWithoutTheOldFolder) {
  const TemporaryFolder folder;
  const auto first = first_in(folder);
  const auto whole = trials_of(run_into(folder, kWider, "whole", first));
  ASSERT_EQ(whole.size(), 20U);
  const auto old = trials_of(first);
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_EQ(whole[k].point, old[k].point);
    EXPECT_EQ(whole[k].outcome->scores, old[k].outcome->scores);
  }
  const auto events = Storage::read(folder / "whole/study.sqlite").events();
  EXPECT_EQ(events.front().kind, EventKind::kNote);
  EXPECT_EQ(events.front().text, "begins with 12 of the 12 trials of first");

  const std::string shorter = replaced(kWider, "evaluations = 20", "evaluations = 14");
  run_into(folder, shorter, "parts", first);
  std::filesystem::remove_all(first);
  const auto parts = trials_of(run_into(folder, kWider, "parts", first));
  ASSERT_EQ(parts.size(), whole.size());
  for (std::size_t k = 0; k < whole.size(); ++k) {
    EXPECT_EQ(parts[k].point, whole[k].point);
    EXPECT_EQ(parts[k].outcome->scores, whole[k].outcome->scores);
  }
}

TEST(WarmStart, LeavesOutWhatLiesOutside) {
  const TemporaryFolder folder;
  const auto first = first_in(folder);
  const Study narrow = study_from_text(
      folder,
      replaced(replaced(kFirst, "max = 40", "max = 30"), "evaluations = 12", "evaluations = 20"));
  const TakenTrials taken = trials_from(narrow, first);
  EXPECT_EQ(taken.found, 12);
  EXPECT_GT(taken.trials.size(), 0U);
  EXPECT_LT(taken.trials.size(), 12U);
  for (const Trial& trial : taken.trials) {
    EXPECT_LE(trial.point[0], 30.0);
  }
}

std::string refusal_of(const TemporaryFolder& folder,
                       const std::string& text,
                       const std::filesystem::path& first) {
  try {
    trials_from(study_from_text(folder, text), first);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

// Taken trials are evaluations: the budget must leave room beside them.
TEST(WarmStart, RefusesABudgetThatLeavesNothingToSearch) {
  const TemporaryFolder folder;
  const auto first = first_in(folder);
  const auto budget = [](const std::string& text, int evaluations) {
    return replaced(text, "evaluations = 20", "evaluations = " + std::to_string(evaluations));
  };
  for (const int evaluations : {5, 12}) {
    EXPECT_THAT(refusal_of(folder, budget(kWider, evaluations), first),
                HasSubstr("its 12 trials count as evaluations: with budget.evaluations = " +
                          std::to_string(evaluations) +
                          " nothing new would be searched; give at least 13"));
  }
  EXPECT_EQ(refusal_of(folder, budget(kWider, 13), first), "");
  // Another design to begin with is an evaluation, too.
  const std::string other = replaced(kWider, "height_mm = 30", "height_mm = 31");
  EXPECT_THAT(refusal_of(folder, budget(other, 13), first), HasSubstr("give at least 14"));
  EXPECT_EQ(refusal_of(folder, budget(other, 14), first), "");
}

// Nor does a stall that is shorter than what the earlier run searched in vain lose them. Nothing is
// rendered: what is new is worse than all.
TEST(WarmStart, AStallCountsFromAfterTheTakenTrials) {
  const TemporaryFolder folder;
  const auto first = first_in(folder);
  const Study study =
      study_from_text(folder, replaced(kWider, "evaluations = 20", "evaluations = 20\nstall = 2"));
  Storage storage = Storage::open(folder / "study.sqlite", {.config_hash = "abc"});
  keep_taken(study, trials_from(study, first), folder.path(), storage);
  SearchTask task = search_task(study, 1);
  const std::map<Point, Outcome> taken = begin_with_taken(folder.path(), task);
  Outcome worst = taken.begin()->second;
  worst.scores["defects.min_weber"] = -1.0;
  const SearchResult result = run_search(task, storage, [&](const Point& point, int) {
    const auto known = taken.find(point);
    return known != taken.end() ? known->second : worst;
  });
  EXPECT_EQ(result.termination, Termination::kStall);
  EXPECT_EQ(result.evaluations, 12 + 2);
}

const std::string kTwo = replaced(kFirst,
                                  "[objective]\nmaximise = \"defects.min_weber\"\n",
                                  R"([[objective]]
maximise = "defects.min_weber"
reference = 0.01
weight = 2
[[objective]]
minimise = "lighting.height_mm"
aspiration = 25
[choice]
by = "weights"
)");

// They weigh scores; what a score means stays.
TEST(WarmStart, TakesTrialsWhoseObjectivesAreWeighedOtherwise) {
  const TemporaryFolder folder;
  const auto first = run_into(folder, kTwo, "first");
  const auto refused = [&](const std::string& before, const std::string& after) {
    const std::string text = replaced(kTwo, "evaluations = 12", "evaluations = 20");
    return refusal_of(folder, replaced(text, before, after), first);
  };
  EXPECT_EQ(refused("reference = 0.01", "reference = 0.02"), "");
  EXPECT_EQ(refused("reference = 0.01\n", ""), "");
  EXPECT_EQ(refused("weight = 2", "weight = 3"), "");
  EXPECT_EQ(refused("aspiration = 25", "aspiration = 22"), "");
  EXPECT_EQ(refused("by = \"weights\"", "by = \"knee\""), "");
  EXPECT_THAT(refused("minimise = \"lighting.height_mm\"\naspiration = 25",
                      "maximise = \"lighting.height_mm\"\naspiration = 25"),
              HasSubstr("objective.1.maximise"));
}

TEST(WarmStart, TellsThatAnotherProgramEvaluatedThem) {
  const TemporaryFolder folder;
  const auto first = first_in(folder);
  {
    Database database(first / "study.sqlite", Database::Access::kReadWrite);
    database.run("UPDATE study SET code_version = '0.1.0-old'");
  }
  const auto run = run_into(folder, kWider, "whole", first);
  EXPECT_EQ(Storage::read(run / "study.sqlite").events().front().text,
            "begins with 12 of the 12 trials of first, which Glint 0.1.0-old evaluated");
  EXPECT_THAT(read_file(run / "log.txt"), HasSubstr("may score the same designs otherwise"));
}

TEST(WarmStart, RefusesWhatMeansSomethingElse) {
  const TemporaryFolder folder;
  const auto first = first_in(folder);
  const auto refused = [&](const std::string& text) {
    return refusal_of(folder, replaced(text, "evaluations = 12", "evaluations = 20"), first);
  };
  EXPECT_EQ(refused(kFirst), "");
  EXPECT_THAT(refused(replaced(kFirst, "height_um = 60", "height_um = 70")),
              HasSubstr("defects.dent.height_um is 70, was 60"));
  EXPECT_THAT(refused(replaced(kFirst, "bits = 0", "bits = 8")),
              HasSubstr("sensor.bits is 8, was 0"));
  EXPECT_THAT(refused(replaced(kFirst, "length_mm = 12", "length_mm = 11")),
              HasSubstr("part.length_mm is 11, was 12"));
  EXPECT_THAT(refused(replaced(kFirst, "outer_radius_mm = 25", "outer_radius_mm = 26")),
              HasSubstr("lighting.ring.outer_radius_mm is 26, was 25"));
  EXPECT_THAT(refused(replaced(
                  kFirst, "maximise = \"defects.min_weber\"", "minimise = \"defects.min_weber\"")),
              HasSubstr("objective"));
  EXPECT_THAT(
      refused(replaced(kFirst, "lighting.ring.radiance.0", "lighting.ring.inner_radius_mm")),
      HasSubstr("is a variable here, but not there"));
  EXPECT_THROW(run_into(folder, kWider, "first", first), ConfigError) << "it has begun";
}

// Which are in its folder already: those of another run would be left out without a word.
TEST(WarmStart, ARunThatHasBegunWithAnotherRunIsRefused) {
  const TemporaryFolder folder;
  const auto first = first_in(folder);
  const auto second = first_in(folder, "second");
  const Study study = study_from_text(folder, kWider);
  const auto out = folder / "out";
  std::filesystem::create_directories(out);
  {
    Storage storage = Storage::open(out / "study.sqlite", {.config_hash = "abc"});
    keep_taken(study, trials_from(study, first / ""), out, storage);
    EXPECT_EQ(storage.events().front().text, "begins with 12 of the 12 trials of first");
  }
  EXPECT_TRUE(trials_to_take(study, first, out).trials.empty());
  EXPECT_TRUE(trials_to_take(study, first / "", out).trials.empty());
  try {
    trials_to_take(study, second, out);
    ADD_FAILURE() << "it has begun with the first";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("has begun with the trials of " + first.string()));
  }
  std::filesystem::remove_all(first);
  EXPECT_TRUE(trials_to_take(study, first, out).trials.empty()) << "the same, though it is gone";
  // It may have been renamed.
  EXPECT_TRUE(trials_to_take(study, second, out).trials.empty());
}

// A refusal leaves the run as it was, also where the study would have widened its space.
TEST(WarmStart, ARunThatHasBegunWithoutIsRefusedBeforeItsSpaceIsWidened) {
  const TemporaryFolder folder;
  const auto first = first_in(folder);
  const auto second = first_in(folder, "second");
  const std::string wider =
      replaced(replaced(kFirst, "max = 40", "max = 60"), "evaluations = 12", "evaluations = 20");
  try {
    run_into(folder, wider, "second", first);
    ADD_FAILURE() << "it has begun";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("has begun without"));
  }
  const Storage storage = Storage::read(second / "study.sqlite");
  EXPECT_EQ(std::ranges::count(storage.events(), EventKind::kEpoch, &Event::kind), 0);
  EXPECT_THAT(storage.identity().config_text, HasSubstr("max = 40"));
  EXPECT_THAT(read_file(second / "study.resolved.toml"), HasSubstr("max = 40"));
}

}  // namespace
}  // namespace glint
