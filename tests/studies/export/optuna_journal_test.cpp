// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/export/optuna_journal.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "optimizer/storage/storage.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;
using Kind = Variable::Kind;

/// A kind of light with variables of its own, and every kind of number.
SearchSpace lights() {
  return {{{.name = "use", .kind = Kind::kChoice, .choices = {"ring", "dome"}},
           {.name = "ring.radius",
            .low = 0.5,
            .high = 8,
            .is_log = true,
            .when_name = "use",
            .when_value = "ring"},
           {.name = "dome.leds",
            .kind = Kind::kInteger,
            .low = 4,
            .high = 9,
            .step = 2,
            .when_name = "use",
            .when_value = "dome"},
           {.name = "height", .low = 1, .high = 2, .step = 0.3}}};
}

Goal goal() {
  return {.objective = {.name = "cnr", .is_maximised = true},
          .constraints = {{.name = "clipped", .min = 0.0, .max = 0.25}}};
}

std::vector<Trial> trials() {
  return {{.number = 1,
           .point = {0, 2, 6, 1.3},
           .outcome = Outcome{.scores = {{"cnr", 4.5}, {"clipped", 0.5}}, .seconds = 1.5}},
          {.number = 2,
           .point = {1, 2, 8, 1.9},
           .outcome = Outcome{.scores = {{"cnr", 2.0}, {"clipped", 0.125}}}},
          {.number = 3,
           .point = {0, 1, 6, 1.0},
           .outcome = Outcome{.is_failed = true, .message = "no light reaches the part"}},
          {.number = 4, .point = {0, 3, 6, 1.0}, .outcome = Outcome{.scores = {{"cnr", 9.0}}}},
          {.number = 5, .point = {0, 3, 6, 1.6}, .outcome = std::nullopt}};
}

std::vector<Json> lines_of(const std::string& text) {
  std::vector<Json> lines;
  for (const std::string& line : split(text, '\n')) {
    if (!line.empty()) {
      lines.push_back(Json::parse(line));
    }
  }
  return lines;
}

TEST(OptunaJournal, HoldsDirectionsDistributionsAndConstraints) {
  OptunaExport counts;
  const auto lines = lines_of(optuna_journal("lights", lights(), goal(), trials(), &counts));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(counts.complete, 2U);
  EXPECT_EQ(counts.failed, 2U);
  EXPECT_EQ(counts.unfinished, 1U);
  EXPECT_EQ(lines[0]["directions"], Json({2}));
  EXPECT_EQ(lines[1]["value"], 4.5);
  EXPECT_EQ(lines[1]["system_attrs"]["constraints"], Json({-0.5, 0.25}));
  EXPECT_FALSE(lines[1]["params"].contains("dome.leds"));
  EXPECT_FALSE(lines[2]["params"].contains("ring.radius"));
  EXPECT_EQ(lines[3]["state"], 3);
  EXPECT_EQ(lines[3]["user_attrs"]["failure"], "no light reaches the part");
  EXPECT_EQ(lines[4]["state"], 3) << "without a limited score the search counts it as failed";
  const Json leds = Json::parse(lines[2]["distributions"]["dome.leds"].get<std::string>());
  EXPECT_EQ(leds["attributes"]["high"], 8) << "the last value that the steps reach";
}

/// The search judges a limited score that has no end; JSON has no number for it.
TEST(OptunaJournal, AnInfiniteLimitedScoreIsFarBeyondItsLimit) {
  std::vector<Trial> all = trials();
  all[0].outcome->scores["clipped"] = std::numeric_limits<double>::infinity();
  OptunaExport counts;
  const auto lines = lines_of(optuna_journal("lights", lights(), goal(), all, &counts));
  EXPECT_EQ(counts.complete, 2U);
  EXPECT_EQ(lines[1]["state"], 1);
  EXPECT_EQ(lines[1]["system_attrs"]["constraints"], Json({-1e300, 1e300}));
}

TEST(OptunaJournal, HoldsEveryDirectionAndValueOfSeveralObjectives) {
  Goal several = goal();
  several.more_objectives = {{.name = several.constraints.at(0).name, .is_maximised = false}};
  const std::vector<Trial> all = trials();
  const auto lines = lines_of(optuna_journal("lights", lights(), several, all));
  EXPECT_EQ(lines[0]["directions"], Json({2, 1}));
  EXPECT_TRUE(lines[1]["value"].is_null());
  const Scores& scores = all[0].outcome->scores;
  EXPECT_EQ(lines[1]["values"],
            Json({scores.at(several.objective.name), scores.at(several.more_objectives[0].name)}));
  EXPECT_TRUE(lines[3]["values"].is_null()) << "failed";
}

TEST(OptunaJournal, IsNotWrittenOverAFileOrFromNoRun) {
  const TemporaryFolder folder;
  write_file(folder / "there.log", "x");
  try {
    export_to_optuna(folder / "run", folder / "there.log");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("exists"));
  }
  EXPECT_EQ(read_file(folder / "there.log"), "x");
  EXPECT_THROW(export_to_optuna(folder / "run", folder / "new.log"), IoError);
  EXPECT_FALSE(fs::exists(folder / "new.log"));
}

constexpr const char* kReader = R"(
import sys, optuna
from optuna.trial import TrialState
path = sys.argv[1]
storage = optuna.storages.JournalStorage(optuna.storages.JournalFileStorage(path))
study = optuna.load_study(study_name='lights', storage=storage)
assert [d.name for d in study.directions] == ['MAXIMIZE'], study.directions
t = study.trials
assert [x.state for x in t] == [TrialState.COMPLETE] * 2 + [TrialState.FAIL] * 2, t
assert t[0].params == {'use': 'ring', 'ring.radius': 2.0, 'height': 1.3}, t[0].params
assert t[1].params == {'use': 'dome', 'dome.leds': 8, 'height': 1.9}, t[1].params
assert t[0].distributions['ring.radius'] == optuna.distributions.FloatDistribution(0.5, 8, log=True)
assert t[1].distributions['dome.leds'] == optuna.distributions.IntDistribution(4, 8, step=2)
assert t[0].system_attrs['constraints'] == [-0.5, 0.25], t[0].system_attrs
assert t[0].duration.total_seconds() == 1.5
assert t[2].user_attrs['failure'] == 'no light reaches the part'
assert study.best_value == 4.5
study.optimize(lambda trial: trial.suggest_float('height', 1, 2), n_trials=1)
assert len(study.trials) == 5
)";

constexpr const char* kFrontReader = R"(
import sys, optuna
path = sys.argv[1]
storage = optuna.storages.JournalStorage(optuna.storages.JournalFileStorage(path))
study = optuna.load_study(study_name='lights', storage=storage)
assert [d.name for d in study.directions] == ['MAXIMIZE', 'MINIMIZE'], study.directions
assert study.trials[0].values == [4.5, 0.5], study.trials[0].values
assert sorted(tuple(t.values) for t in study.best_trials) == [(2.0, 0.125), (4.5, 0.5)]
)";

constexpr const char* kImportanceReader = R"(
import sys, optuna
path = sys.argv[1]
storage = optuna.storages.JournalStorage(optuna.storages.JournalFileStorage(path))
study = optuna.load_study(study_name='bowl', storage=storage)
shares = optuna.importance.get_param_importances(study)
assert list(shares)[0] == 'steep' and shares['steep'] > 0.8, shares
)";

constexpr const char* kPlotter = R"(
import sys, optuna
path = sys.argv[1]
storage = optuna.storages.JournalStorage(optuna.storages.JournalFileStorage(path))
study = optuna.load_study(study_name='bowl', storage=storage)
seen, best = optuna.visualization.plot_optimization_history(study).data[:2]
assert list(seen.y) == [t.value for t in study.trials], seen
assert len(best.y) == 40 and best.y[-1] == study.best_value, best
bars = optuna.visualization.plot_param_importances(study).data[0]
assert max(zip(bars.x, bars.y))[1] == 'steep' and set(bars.y) == {'steep', 'flat'}, bars
)";

constexpr const char* kFrontPlotter = R"(
import sys, optuna
path = sys.argv[1]
storage = optuna.storages.JournalStorage(optuna.storages.JournalFileStorage(path))
study = optuna.load_study(study_name='lights', storage=storage)
others, front = optuna.visualization.plot_pareto_front(study).data
assert list(zip(others.x, others.y)) == [(1.0, 0.5)], others
assert sorted(zip(front.x, front.y)) == [(2.0, 0.125), (4.5, 0.5)], front
)";

/// Whether a program of Python that reads a journal ends well.
bool python_reads(const std::string& journal, const std::string& program) {
  const TemporaryFolder folder;
  write_file(folder / "study.log", journal);
  write_file(folder / "read.py", program);
  const std::string command = "/usr/bin/python3 -W ignore " + (folder / "read.py").string() + " " +
                              (folder / "study.log").string();
  return std::system(command.c_str()) == 0;
}

bool has_python_module(const std::string& name) {
  return std::system(("/usr/bin/python3 -W ignore -c 'import " + name + "' 2>/dev/null").c_str()) ==
         0;
}

TEST(OptunaJournal, IsOpenedByOptuna) {
  if (!has_python_module("optuna")) {
    GTEST_SKIP() << "needs Optuna: script/bootstrap --peers";
  }
  EXPECT_TRUE(python_reads(optuna_journal("lights", lights(), goal(), trials()), kReader));
}

TEST(OptunaJournal, OfSeveralObjectivesHasTheSameFrontInOptuna) {
  if (!has_python_module("optuna")) {
    GTEST_SKIP() << "needs Optuna: script/bootstrap --peers";
  }
  Goal several = goal();
  several.constraints = {};
  several.more_objectives = {{.name = "clipped", .is_maximised = false}};
  const std::vector<Trial> two = {trials()[0], trials()[1]};
  EXPECT_TRUE(python_reads(optuna_journal("lights", lights(), several, two), kFrontReader));
}

/// A score that one of two variables makes, in 40 even designs.
std::string bowl_journal() {
  const SearchSpace space = {{{.name = "steep"}, {.name = "flat"}}};
  std::vector<Trial> even;
  for (int i = 0; i < 40; ++i) {
    const double steep = std::fmod(0.5 + 0.618034 * i, 1.0);
    const double flat = (i + 0.5) / 40.0;
    even.push_back({.number = i + 1,
                    .point = {steep, flat},
                    .outcome = Outcome{.scores = {{"cnr", 4.0 * steep + 0.1 * flat}}}});
  }
  return optuna_journal("bowl", space, {.objective = {.name = "cnr"}, .constraints = {}}, even);
}

TEST(OptunaJournal, IsAnalysedByOptuna) {
  if (!has_python_module("optuna, sklearn")) {
    GTEST_SKIP() << "needs Optuna and scikit-learn: script/bootstrap --peers";
  }
  EXPECT_TRUE(python_reads(bowl_journal(), kImportanceReader));
}

TEST(OptunaJournal, IsPlottedByOptuna) {
  if (!has_python_module("optuna, plotly, sklearn")) {
    GTEST_SKIP() << "needs Optuna, Plotly and scikit-learn: script/bootstrap --peers";
  }
  EXPECT_TRUE(python_reads(bowl_journal(), kPlotter));
}

TEST(OptunaJournal, OfSeveralObjectivesHasItsFrontPlottedByOptuna) {
  if (!has_python_module("optuna, plotly")) {
    GTEST_SKIP() << "needs Optuna and Plotly: script/bootstrap --peers";
  }
  Goal several = goal();
  several.constraints = {};
  several.more_objectives = {{.name = "clipped", .is_maximised = false}};
  std::vector<Trial> three = {trials()[0], trials()[1], trials()[1]};
  three[2].number = 3;
  three[2].outcome->scores = {{"cnr", 1.0}, {"clipped", 0.5}};
  EXPECT_TRUE(python_reads(optuna_journal("lights", lights(), several, three), kFrontPlotter));
}

}  // namespace
}  // namespace glint
