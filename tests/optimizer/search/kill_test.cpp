// SPDX-License-Identifier: GPL-3.0-or-later
//
// kill -9 at random moments: no recorded evaluation is lost or repeated, and the result is the one
// of an uninterrupted search, bit for bit.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "optimizer/search/search.h"
#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

/// Searched in two epochs: 120 designs are evaluated again.
constexpr const char* kInEpochs = "in epochs";
constexpr int kOfFirstEpoch = 120;
constexpr int kNextEpoch = 1000;  ///< added to a trial's number in the diary

/// gp with derivatives, and gp with two objectives.
constexpr const char* kWithDerivatives = "with derivatives";
constexpr const char* kOfTwo = "of two objectives";

std::string algorithm_of(const std::string& search) {
  return search == kInEpochs                              ? "auto"
         : search == kWithDerivatives || search == kOfTwo ? "gp"
                                                          : search;
}

SearchTask killable_task(const std::string& search) {
  const std::string algorithm = algorithm_of(search);
  SearchTask task = {.space = test::mixed_space_for(algorithm),
                     .settings = {.algorithm = algorithm, .batch = 2},
                     .goal = {.objective = {.name = "loss", .is_maximised = false},
                              .constraints = {{.name = "length", .max = 0.8}}},
                     .budget = {.evaluations = 250},
                     .jobs = 2};
  if (search == kWithDerivatives) {
    task.space = test::smooth_mixed_space();
    task.settings.derivatives = true;
  }
  if (search == kOfTwo || algorithm == "sobol" || needs_several_objectives(algorithm)) {
    task.goal.more_objectives = {{.name = "length", .is_maximised = true}};
  }
  return task;
}

int recorded_epochs(const Storage& storage) {
  const std::vector<Event> events = storage.events();
  return static_cast<int>(std::ranges::count(events, EventKind::kEpoch, &Event::kind));
}

Outcome killable_outcome(const Point& point, int trial) {
  if (trial % 11 == 4) {
    throw Error("every eleventh fails");
  }
  return {.scores = {{"loss", test::mixed_value(point) + test::noise(trial)}, {"length", point[0]}},
          .gradients = {{"loss", test::mixed_gradient(point)},
                        {"length", {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}}}};
}

/// One line per started and per recorded evaluation, written at once so that a kill cannot lose it.
class Diary {
 public:
  explicit Diary(const std::filesystem::path& path)
      : file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600)) {}

  ~Diary() { ::close(file_); }

  Diary(const Diary&) = delete;
  Diary& operator=(const Diary&) = delete;

  void note(char what, int trial) const {
    const std::string line = fmt::format("{} {}\n", what, trial);
    ASSERT_EQ(::write(file_, line.data(), line.size()), static_cast<ssize_t>(line.size()));
  }

 private:
  int file_;
};

SearchResult search_in(const TemporaryFolder& folder, const std::string& algorithm) {
  const Diary diary(folder / "diary");
  Storage storage = Storage::open(folder / "s.sqlite", test::identity());
  const bool is_in_epochs = algorithm == kInEpochs;
  int epoch = recorded_epochs(storage);
  SearchTask task = killable_task(algorithm);
  if (is_in_epochs) {
    task.review = [&](std::span<const Trial> told, TimeLeft) -> std::optional<Event> {
      if (epoch > 0 || told.size() < kOfFirstEpoch) {
        return std::nullopt;
      }
      ++epoch;
      return Event{.kind = EventKind::kEpoch, .trial = 1};
    };
  }
  task.label = [&](const Point&) { return OutcomeLabel{.rung = fmt::format("epoch {}", epoch)}; };
  const auto number = [&](int trial) { return trial + kNextEpoch * epoch; };
  return run_search(
      task,
      storage,
      [&](const Point& point, int trial) {
        diary.note('s', number(trial));
        std::this_thread::sleep_for(std::chrono::microseconds(1000));
        return killable_outcome(point, number(trial));
      },
      nullptr,
      [&](const SearchProgress& progress) { diary.note('r', number(progress.last.number)); });
}

/// True when the child ended by itself.
bool run_and_kill(const TemporaryFolder& folder, const std::string& algorithm, int delay_us) {
  const pid_t child = ::fork();
  if (child == 0) {
    int code = 1;
    try {
      search_in(folder, algorithm);
      code = 0;
    } catch (const std::exception& error) {
      static_cast<void>(fprintf(stderr, "child: %s\n", error.what()));
    }
    ::_exit(code);
  }
  std::this_thread::sleep_for(std::chrono::microseconds(delay_us));
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status)) {
    EXPECT_EQ(WEXITSTATUS(status), 0);
    return true;
  }
  return false;
}

/// Everything but times.
std::string contents_of(const TemporaryFolder& folder) {
  const Storage storage = Storage::read(folder / "s.sqlite");
  std::string text;
  for (const Event& event : storage.events()) {
    text += fmt::format("{} {} {:a} {} [{:a}]\n",
                        static_cast<int>(event.kind),
                        event.trial,
                        event.value,
                        event.text,
                        fmt::join(event.objectives, " "));
  }
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    text += fmt::format("{} {:a}", trial.number, fmt::join(trial.point, " "));
    if (trial.outcome) {
      text += " " + trial.outcome->message;
      for (const auto& [name, value] : trial.outcome->scores) {
        text += fmt::format(" {} {:a}", name, value);
      }
      for (const auto& [name, gradient] : trial.outcome->gradients) {
        text += fmt::format(" d{} {:a}", name, fmt::join(gradient, " "));
      }
    }
    text += '\n';
  }
  for (const Replicate& one : storage.replicates(TrialKind::kSearch)) {
    text += fmt::format("{} in {} {}", one.number, one.rung, one.outcome.message);
    for (const auto& [name, value] : one.outcome.scores) {
      text += fmt::format(" {} {:a}", name, value);
    }
    text += '\n';
  }
  return text;
}

int kept_outcomes(const TemporaryFolder& folder) {
  const Storage storage = Storage::read(folder / "s.sqlite");
  return static_cast<int>(storage.replicates(TrialKind::kSearch).size());
}

/// No evaluation was started again after it had been reported as recorded.
void expect_nothing_repeated(const TemporaryFolder& folder, std::size_t num_kills) {
  std::ifstream diary(folder / "diary");
  std::set<int> recorded;
  char what = 0;
  int trial = 0;
  while (diary >> what >> trial) {
    if (what == 's') {
      EXPECT_FALSE(recorded.contains(trial)) << "trial " << trial << " was evaluated again";
    } else {
      recorded.insert(trial);
    }
  }
  // A kill between recording and writing the line loses the line, at most one per kill and job.
  EXPECT_GE(recorded.size(), 250U - 2U * num_kills);
}

/// What an int of microseconds holds.
constexpr double kMaxDelayUs = 1e9;

std::size_t recorded_evaluations(const TemporaryFolder& folder) {
  std::ifstream diary(folder / "diary");
  std::size_t count = 0;
  for (std::string line; std::getline(diary, line);) {
    if (line.starts_with('r')) {
      ++count;
    }
  }
  return count;
}

/// Runs and kills it until it ends by itself. A busy machine may begin nothing in the time that it
/// has: a kill before any evaluation is recorded doubles that time. @return the number of kills
std::size_t kill_until_it_ends(const TemporaryFolder& folder,
                               const std::string& algorithm,
                               double longest_us,
                               Rng& rng) {
  std::size_t kills = 0;
  std::size_t recorded = 0;
  while (!run_and_kill(folder, algorithm, static_cast<int>(rng.uniform(0.0, longest_us)))) {
    ++kills;
    const std::size_t now = recorded_evaluations(folder);
    longest_us = now > recorded ? longest_us : std::min(2.0 * longest_us, kMaxDelayUs);
    recorded = now;
  }
  return kills;
}

/// @return the number of kills, at least num_kills
std::size_t expect_survival(const std::string& algorithm, std::size_t num_kills) {
  const TemporaryFolder reference;
  const auto begin = std::chrono::steady_clock::now();
  const SearchResult expected = search_in(reference, algorithm);
  // A child must get further than opening its files, also where disks are slow.
  const double whole_us =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  const double longest_us = std::max(40000.0, whole_us / 8.0);
  const std::string expected_contents = contents_of(reference);
  EXPECT_EQ(expected.evaluations, 250);
  EXPECT_NE(expected_contents.find("dloss"), std::string::npos);
  EXPECT_GE(kept_outcomes(reference), 250 + (algorithm == kInEpochs ? kOfFirstEpoch : 0));

  Rng rng(8, Stream::kTest, 0);
  std::size_t kills = 0;
  while (kills < num_kills) {
    const TemporaryFolder folder;
    kills += kill_until_it_ends(folder, algorithm, longest_us, rng);
    EXPECT_EQ(contents_of(folder), expected_contents) << algorithm;
    expect_nothing_repeated(folder, kills);
  }
  return kills;
}

TEST(RunSearch, SurvivesKillsAtRandomMoments) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer cannot follow threads begun after fork()";
#endif
  // sobol and nsga2: two objectives
  for (const char* algorithm : {"auto", "slsqp", "sobol", kInEpochs}) {
    expect_survival(algorithm, 15);
  }
  for (const char* algorithm : {"gp", "cmaes", "nsga2"}) {  // they take longest
    expect_survival(algorithm, 3);
  }
}

/// Two hundred kills: some minutes, so only where they are asked for.
TEST(RunSearch, SurvivesKillsWithEveryMethod) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer cannot follow threads begun after fork()";
#endif
  if (std::getenv("GLINT_ALL_KILLS") == nullptr) {
    GTEST_SKIP() << "slow: the test optimizer_long asks for it";
  }
  std::vector<std::string> searches = {kInEpochs, kWithDerivatives, kOfTwo};
  for (const std::string_view algorithm : algorithm_names()) {
    searches.emplace_back(algorithm);
  }
  std::size_t kills = 0;
  for (const std::string& search : searches) {
    kills += expect_survival(search, 10);
  }
  EXPECT_GE(kills, 200U);
}

}  // namespace
}  // namespace glint
