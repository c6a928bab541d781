// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/search_answer.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "optimizer/algorithm/merit.h"

namespace glint {
namespace {

/// One per tell; empty where scores are not noisy.
std::vector<std::vector<Expectation>> expected_rows(const SearchTask& task,
                                                    const SearchMemory& memory) {
  const bool is_noisy = task.settings.is_noisy || tells_noise(task.goal, memory.trials);
  return is_noisy && task.settings.rules > 1 ? memory.algorithm->expected_objectives()
                                             : std::vector<std::vector<Expectation>>{};
}

/// By rules 7 of what noisy scores are expected to be, where a model knows. What of that is within
/// the limits may be nothing, and what was not told before the end may be: of this, what was seen.
void take_compromise(const SearchTask& task, const SearchMemory& memory, SearchResult& result) {
  const Goal& goal = task.goal;
  const bool is_expected = task.settings.is_noisy && task.settings.rules > 6;
  if (is_expected) {
    result.expected =
        with_exact_scores(goal, memory.trials, task.exact.names, std::move(result.expected));
  }
  result.trade_off = trade_off(goal,
                               memory.trials,
                               memory.reference,
                               is_expected ? result.expected : Expectations{},
                               result.limits);
  if (result.trade_off->trials.empty()) {
    result.trade_off = trade_off(goal, memory.trials, memory.reference, {}, result.limits);
  }
  const TradeOff& found = *result.trade_off;
  if (!found.trials.empty()) {
    result.best = memory.trial(found.trials[found.chosen]);
  }
  if (found.outside > 0) {
    result.warnings.push_back(
        "the reference lies inside the front: " + std::to_string(found.outside) + " of its " +
        std::to_string(found.front.size()) +
        " designs are not better than it in every objective and add nothing to the hypervolume");
  }
}

}  // namespace

std::string algorithm_of(const SearchTask& task) {
  return resolved_algorithm(task.space, task.settings, num_objectives(task.goal));
}

LimitExpectations expected_limits_of(const SearchTask& task, const SearchMemory& memory) {
  if (!task.settings.is_noisy || task.settings.rules < 8 || task.goal.constraints.empty()) {
    return {};
  }
  std::vector<std::string> as_seen = task.exact.names;
  as_seen.insert(as_seen.end(), task.steady.begin(), task.steady.end());
  return limit_expectations_of(
      task.goal, memory.trials, memory.tells, memory.algorithm->expected_limits(), as_seen);
}

void take_answer(const SearchTask& task, const SearchMemory& memory, SearchResult& result) {
  const std::vector<std::vector<Expectation>> expected = expected_rows(task, memory);
  result.expected = expectations_of(task.goal, memory.tells, expected);
  result.limits = expected_limits_of(task, memory);
  result.best = most_likely_feasible(task.goal, memory.trials, result.limits);
  if (has_several_objectives(task.goal)) {
    take_compromise(task, memory, result);
  } else if (task.settings.is_noisy && task.settings.rules > 1) {
    const std::optional<int> best =
        expected_best(task.goal, memory.trials, memory.tells, expected, result.limits);
    result.best = best ? memory.trial(*best) : result.best;
  }
  if (!result.best) {
    return;
  }
  result.is_feasible = is_likely_feasible(task.goal, *result.best, result.limits);
  if (const auto known = result.limits.find(result.best->number); known != result.limits.end()) {
    result.judged_limits = JudgedLimits{.expected = known->second};
  }
}

}  // namespace glint
