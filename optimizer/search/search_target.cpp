// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/search_target.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/text.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/search/search_answer.h"

namespace glint {
namespace {

/// The target that the run was last looked at with, NaN: none.
double recorded_target(std::span<const Event> log) {
  double target = std::numeric_limits<double>::quiet_NaN();
  for (const Event& event : log) {
    if (event.kind == EventKind::kNote && !event.objectives.empty()) {
      target = event.objectives.front();
    }
  }
  return target;
}

double target_of(const Budget& budget) {
  return budget.target.value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

SearchTarget::SearchTarget(const SearchTask& task, std::span<const Event> log)
    : task_(task),
      has_model_(algorithm_of(task) == "gp"),
      judges_limits_(task.settings.is_noisy && task.settings.rules > 7 && has_model_) {
  const double now = target_of(task.budget);
  const double before = recorded_target(log);
  const bool is_same = now == before || (std::isnan(now) && std::isnan(before));
  is_new_ = judges_limits_ && !is_same;
}

bool SearchTarget::is_reached(const SearchMemory& memory) {
  if (!task_.budget.target || memory.num_told < memory.num_given) {
    return false;
  }
  if (!task_.settings.is_noisy || task_.settings.rules < 6) {
    return has_seen_it(memory);
  }
  return may_be_expected(memory) && has_seen_it(memory) && is_expected_of_best(memory);
}

std::optional<Event> SearchTarget::take_event() {
  if (!is_new_) {
    return std::nullopt;
  }
  is_new_ = false;
  const double target = target_of(task_.budget);
  return Event{
      .kind = EventKind::kNote,
      .text = std::isnan(target) ? "no budget.target" : "budget.target " + shortest(target),
      .objectives = {target}};
}

bool SearchTarget::is_beyond(double value) const {
  const double target = *task_.budget.target;
  return task_.goal.objective.is_maximised ? value >= target : value <= target;
}

/// As it was seen; limits count where models do not judge them.
bool SearchTarget::has_reached(const Trial& told) const {
  return !told.outcome->is_failed &&
         (judges_limits_ || is_feasible(task_.goal, told.outcome->scores)) &&
         is_beyond(told.outcome->scores.at(task_.goal.objective.name));
}

/// Whether an evaluation that was told has reached it.
bool SearchTarget::has_seen_it(const SearchMemory& memory) const {
  if (!judges_limits_) {
    return memory.best && has_reached(memory.trial(*memory.best));
  }
  return std::ranges::any_of(memory.tells,
                             [&](int number) { return has_reached(memory.trial(number)); });
}

/// Whether the model can have come to expect the target by the last batch, to which all belongs
/// that an earlier run gave. By rules 6 it is asked after every batch.
bool SearchTarget::may_be_expected(const SearchMemory& memory) const {
  const auto given = static_cast<std::size_t>(memory.num_given);
  const std::size_t begin = memory.told_before_batch < given ? 0 : memory.told_before_batch;
  const auto batch = std::span(memory.tells).subspan(begin);
  return task_.settings.rules < 7 || !has_model_ || is_new_ || memory.has_new_model() ||
         std::ranges::any_of(batch, [&](int number) { return has_reached(memory.trial(number)); });
}

/// What one lucky evaluation does not make; of methods without models nothing else is known.
bool SearchTarget::is_expected_of_best(const SearchMemory& memory) {
  ++num_questions_;
  const std::vector<std::vector<Expectation>> rows = memory.algorithm->expected_objectives();
  const auto best = expected_best(
      task_.goal, memory.trials, memory.tells, rows, expected_limits_of(task_, memory));
  return best ? is_expected(expectations_of(task_.goal, memory.tells, rows), *best) : !has_model_;
}

bool SearchTarget::is_expected(const Expectations& expected, int number) const {
  const auto found = expected.find(number);
  return found != expected.end() && is_beyond(found->second.front().mean);
}

}  // namespace glint
