// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/task_check.h"

#include <vector>

#include "core/config/keys.h"
#include "core/error.h"

namespace glint {

void check_task(const SearchTask& task) {
  const Budget& budget = task.budget;
  std::vector<Problem> errors;
  if (budget.evaluations < 0 || budget.stall < 0 || !(budget.wall_clock_s >= 0.0)) {
    errors.push_back({.key = "budget", .text = "limits must not be negative, 0 means no limit"});
  }
  if (budget.evaluations == 0 && budget.stall == 0 && budget.wall_clock_s <= 0.0 &&
      !budget.target) {
    errors.push_back(
        {.key = "budget",
         .text = "at least one of evaluations, wall clock, stall and target is needed"});
  }
  if (budget.target && has_several_objectives(task.goal)) {
    errors.push_back({.key = "budget.target",
                      .text = "works with a single objective only, this task has several; allowed: "
                              "evaluations, wall clock, stall"});
  }
  if (task.jobs < 1) {
    errors.push_back({.key = "jobs", .text = "must be at least 1"});
  }
  for (const Point& point : task.start_points) {
    if (point.size() != task.space.variables.size()) {
      errors.push_back({.key = "start point", .text = "needs one value per variable"});
    }
  }
  throw_if_any(errors);
}

std::string problem_with_outcome(const SearchTask& task,
                                 const Point& point,
                                 const Outcome& outcome) {
  std::string problem = problem_with(task.goal, outcome.scores);
  const std::string algorithm =
      resolved_algorithm(task.space, task.settings, num_objectives(task.goal));
  if (problem.empty() && needs_gradient(algorithm)) {
    problem = problem_with_gradients(task.space, task.goal, point, outcome);
    if (!problem.empty()) {
      problem += ", which " + algorithm + " needs; other algorithms do without";
      problem += outcome.remarks.empty() ? "" : " (" + text_of(outcome.remarks) + ")";
    }
  }
  if (problem.empty() && task.settings.derivatives) {
    problem = problem_without_derivatives(task.space, task.goal, point, outcome);
  }
  return problem;
}

void make_storable(Outcome& outcome) {
  for (auto& [name, value] : outcome.scores) {
    value += 0.0;
  }
  std::erase_if(outcome.gradients, [](const auto& entry) { return entry.second.empty(); });
  for (auto& [name, gradient] : outcome.gradients) {
    for (double& value : gradient) {
      value += 0.0;
    }
  }
}

}  // namespace glint
