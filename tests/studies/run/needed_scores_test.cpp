// SPDX-License-Identifier: GPL-3.0-or-later
//
// search.scores = "needed": designs of the search without the scores that need the flawless part.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "optimizer/storage/storage.h"
#include "studies/definition/study_text.h"
#include "studies/run/run.h"
#include "studies/run/study_search.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

const std::string kThreeDesigns = "schema = 1\n" + kPathPlate + kPathRing + R"(
[variables]
"lighting.ring.height_mm" = { min = 20, max = 40 }
[objective]
maximise = "defects.min_weber"
[constraints]
"homogeneity.mean" = { max = 0.9 }
[budget]
evaluations = 8
[search]
algorithm = "crs2"
)";

Study study_from(const TemporaryFolder& folder,
                 const std::string& text,
                 const std::vector<KeyValue>& sets = {}) {
  write_file(folder / "study.toml", text);
  return load_study(folder / "study.toml", sets);
}

Json run_into(const std::filesystem::path& out, const Study& study) {
  return run_study(
      study,
      {.out = out, .threads = 2, .jobs = 1, .progress = Progress::Style::kNone, .log_file = {}});
}

std::vector<Trial> trials_in(const std::filesystem::path& out) {
  return Storage::read(out / "study.sqlite").trials(TrialKind::kSearch);
}

const std::string kNeeded = kThreeDesigns + "scores = \"needed\"\n";

/// What a run of kNeeded has left, for tests that only read it: made once.
struct NeededRun {
  TemporaryFolder folder;
  Json result = run_into(folder / "out", study_from(folder, kNeeded));

  std::filesystem::path out() const { return folder / "out"; }
};

const NeededRun& needed_run() {
  static const NeededRun run{};
  return run;
}

TEST(NeededScores, KeyIsWrittenWhereItIsGivenAlone) {
  const TemporaryFolder folder;
  EXPECT_THAT(resolved_text(study_from(folder, kThreeDesigns)), Not(HasSubstr("scores = ")));
  const Study needed = study_from(folder, kNeeded);
  EXPECT_THAT(resolved_text(needed), HasSubstr("scores = \"needed\""));
  EXPECT_FALSE(wanted_in_search(needed).changes);
  EXPECT_TRUE(wanted_in_search(study_from(folder, kThreeDesigns)).changes);
  EXPECT_NE(config_hash(needed), config_hash(study_from(folder, kThreeDesigns)));
  EXPECT_THROW(study_from(folder, kThreeDesigns + "scores = \"some\"\n"), ConfigError);
}

TEST(NeededScores, ChangesAreNeededWhereTheGoalOrAWishNamesThem) {
  const TemporaryFolder folder;
  for (const char* key : {"constraints.\"defects.min_change\"",
                          "constraints.\"defects.dent_1.union\"",
                          "constraints.\"defects.mean_change\""}) {
    const Study study = study_from(folder, kNeeded, {{key, "{ min = 0.0 }"}});
    EXPECT_TRUE(wanted_in_search(study).changes) << key;
  }
}

TEST(NeededScores, OtherScoresAreTheSameBytesAndFinalistsHaveAll) {
  const TemporaryFolder folder;
  const Json all = run_into(folder / "all", study_from(folder, kThreeDesigns));
  const Json& needed = needed_run().result;
  const auto whole = trials_in(folder / "all");
  const auto few = trials_in(needed_run().out());
  ASSERT_EQ(whole.size(), few.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(whole[i].point, few[i].point);
    Scores scores = whole[i].outcome->scores;
    EXPECT_GT(std::erase_if(scores, [](const auto& row) { return needs_flawless(row.first); }), 0U);
    EXPECT_EQ(scores, few[i].outcome->scores);
  }
  EXPECT_EQ(needed.at("best").at("trial"), all.at("best").at("trial"));
  const auto winner = [](const std::filesystem::path& out) {
    return Json::parse(read_file(out / "winner/scores.json")).at("scores");
  };
  EXPECT_TRUE(winner(needed_run().out()).contains("defects.min_change"));
  EXPECT_EQ(winner(needed_run().out()), winner(folder / "all"));
}

TEST(NeededScores, ALargerBudgetGoesOnToTheSameTrials) {
  const TemporaryFolder folder;
  run_into(folder / "cut", study_from(folder, kNeeded, {{"budget.evaluations", "4"}}));
  run_into(folder / "cut", study_from(folder, kNeeded));
  const auto whole = trials_in(needed_run().out());
  const auto resumed = trials_in(folder / "cut");
  ASSERT_EQ(whole.size(), resumed.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(whole[i].point, resumed[i].point);
    EXPECT_EQ(whole[i].outcome->scores, resumed[i].outcome->scores);
  }
}

}  // namespace
}  // namespace glint
