// SPDX-License-Identifier: GPL-3.0-or-later
//
// kill -9 of `glint run` at random moments, also while it writes its results: no evaluation is
// lost, and in the end the run directory is that of an uninterrupted run, byte for byte.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include "core/rng.h"
#include "tests/cli/record.h"

#ifndef GLINT_NUM_KILLS
#define GLINT_NUM_KILLS 10
#endif

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Milliseconds = std::chrono::duration<double, std::milli>;

const Arguments kQuietRun = {"run", "study.toml", "--quiet", "--out", "out"};

/// How many designs the runs in this folder have begun to write.
std::ptrdiff_t designs_begun(const fs::path& out) {
  if (!fs::exists(out / "log.txt")) {
    return 0;
  }
  const std::string log = read_file(out / "log.txt");
  std::ptrdiff_t count = 0;
  for (auto at = log.find("writing "); at != std::string::npos; at = log.find("writing ", at + 1)) {
    ++count;
  }
  return count;
}

/// What a kill waits for before its random delay.
enum class After { kStart, kEvaluation, kDesign };

bool has_come(After after, const fs::path& out, std::size_t evaluations, std::ptrdiff_t designs) {
  switch (after) {
    case After::kEvaluation:
      return recorded_evaluations(out).size() > evaluations;
    case After::kDesign:
      return designs_begun(out) > designs;
    default:
      return true;
  }
}

/// Starts a run and kills it. False when it had ended before.
bool run_and_kill_program(const fs::path& folder, After after, double delay_ms) {
  const fs::path out = folder / "out";
  const std::size_t evaluations = recorded_evaluations(out).size();
  const std::ptrdiff_t designs = designs_begun(out);
  Program program(folder, kQuietRun);
  while (program.is_running() && !has_come(after, out, evaluations, designs)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::this_thread::sleep_for(Milliseconds(delay_ms));
  program.send(SIGKILL);
  const ProgramResult result = program.wait();
  if (result.signal == SIGKILL) {
    return true;
  }
  EXPECT_EQ(result.code, 0) << result.err;
  return false;
}

/// How long the phases of a run take.
struct PhaseTimes {
  double start_ms = 0.0;  ///< until the first evaluation is recorded
  double search_ms = 0.0;
  double writing_ms = 0.0;

  double of(After after) const {
    return after == After::kStart        ? 1.2 * start_ms
           : after == After::kEvaluation ? 0.8 * search_ms
                                         : 1.1 * writing_ms;
  }
};

PhaseTimes run_uninterrupted(const fs::path& folder) {
  const auto start = std::chrono::steady_clock::now();
  const auto passed_ms = [&] {
    return Milliseconds(std::chrono::steady_clock::now() - start).count();
  };
  const auto wait_for = [&](Program& program, After after) {
    while (program.is_running() && !has_come(after, folder / "whole", 0, 0)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return passed_ms();
  };
  Program program(folder, {"run", "study.toml", "--quiet", "--out", "whole"});
  const double evaluation_ms = wait_for(program, After::kEvaluation);
  const double design_ms = wait_for(program, After::kDesign);
  EXPECT_EQ(program.wait().code, 0);
  return {.start_ms = evaluation_ms,
          .search_ms = design_ms - evaluation_ms,
          .writing_ms = passed_ms() - design_ms};
}

/// Kills at random moments of all phases until there were enough; each series of kills ends with a
/// run that ends by itself.
class KillSeries {
 public:
  explicit KillSeries(const fs::path& folder)
      : folder_(folder), times_(run_uninterrupted(folder)) {}

  void run_until_done() {
    fs::remove_all(folder_ / "out");
    std::map<int, Outcome> recorded;
    bool was_killed = true;
    while (was_killed) {
      const double choice = rng_.uniform(0.0, 1.0);
      const After after = choice < 0.2   ? After::kStart
                          : choice < 0.7 ? After::kEvaluation
                                         : After::kDesign;
      was_killed = run_and_kill_program(folder_, after, rng_.uniform(0.0, times_.of(after)));
      const auto now = recorded_evaluations(folder_ / "out");
      expect_kept(recorded, now);
      recorded = now;
      kills += was_killed ? 1 : 0;
      kills_in_search += was_killed && !recorded.empty() && recorded.size() < 40 ? 1 : 0;
      kills_while_writing += was_killed && after == After::kDesign ? 1 : 0;
    }
    EXPECT_EQ(recorded.size(), 40U);
    expect_same_files(folder_ / "out", folder_ / "whole");
  }

  int kills = 0;
  int kills_in_search = 0;
  int kills_while_writing = 0;

 private:
  fs::path folder_;
  PhaseTimes times_;
  Rng rng_{7, Stream::kTest, 0};
};

TEST(Kill, AtRandomMomentsLosesNoEvaluationAndChangesNoResult) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", slow_study());
  KillSeries series(folder.path());
  constexpr int kEnough = GLINT_NUM_KILLS / 5;
  while (!HasFailure() && (series.kills < GLINT_NUM_KILLS || series.kills_in_search < kEnough ||
                           series.kills_while_writing < kEnough)) {
    series.run_until_done();
  }
  RecordProperty("kills", series.kills);
  RecordProperty("kills_in_search", series.kills_in_search);
  RecordProperty("kills_while_writing", series.kills_while_writing);
}

}  // namespace
}  // namespace glint::test
