// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches into a folder, and what they leave there.
#pragma once

#include <atomic>
#include <initializer_list>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "optimizer/search/search.h"
#include "optimizer/storage/storage.h"
#include "tests/optimizer/algorithm/problems.h"
#include "tests/support/temporary_folder.h"

namespace glint::test {

inline SearchResult search_into(const TemporaryFolder& folder,
                                const SearchTask& task,
                                const Evaluate& evaluate,
                                const std::atomic<int>* interrupt = nullptr,
                                const OnEvaluation& progress = {}) {
  Storage storage = Storage::open(folder / "s.sqlite", identity());
  return run_search(task, storage, evaluate, interrupt, progress);
}

/// Everything but times.
inline std::string events_and_points(const TemporaryFolder& folder) {
  const Storage storage = Storage::read(folder / "s.sqlite");
  std::string text;
  for (const Event& event : storage.events()) {
    text += fmt::format("{} {} {:a} [{:a}]\n",
                        static_cast<int>(event.kind),
                        event.trial,
                        event.value,
                        fmt::join(event.objectives, " "));
  }
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    text += fmt::format("{} {:a}\n", trial.number, fmt::join(trial.point, " "));
  }
  return text;
}

/// Expects a search that is resumed, with and without asking everything again, to leave what is in
/// another folder. @param budgets  in evaluations, of the parts that it is done in
inline void expect_resumed_as(const TemporaryFolder& whole,
                              SearchTask task,
                              const Evaluate& evaluate,
                              std::initializer_list<int> budgets) {
  for (const bool verify : {false, true}) {
    const TemporaryFolder cut;
    for (const int evaluations : budgets) {
      task.budget.evaluations = evaluations;
      task.verify_replay = verify;
      search_into(cut, task, evaluate);
    }
    EXPECT_EQ(events_and_points(cut), events_and_points(whole)) << verify;
  }
}

}  // namespace glint::test
