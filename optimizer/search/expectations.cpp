// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/expectations.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "optimizer/algorithm/merit.h"

namespace glint {
namespace {

/// Of a variable's range: designs that differ by less in every variable are one design.
constexpr double kSameDesign = 0.01;

bool is_judgeable(const Goal& goal, const Trial& trial) {
  return trial.outcome && !trial.outcome->is_failed &&
         problem_with(goal, trial.outcome->scores).empty();
}

/// Smaller is better; of the model where it knows the trial.
double expected_value(const Goal& goal, const Trial& trial, const Expectations& expected) {
  const auto found = expected.find(trial.number);
  if (found == expected.end()) {
    return minimised_objectives(goal, trial.outcome->scores).front();
  }
  return (goal.objective.is_maximised ? -1.0 : 1.0) * found->second.front().mean;
}

bool are_alike(const SearchSpace& space, const Point& a, const Point& b) {
  const std::vector<double> unit_a = unit_from_point(space, a);
  const std::vector<double> unit_b = unit_from_point(space, b);
  for (std::size_t i = 0; i < unit_a.size(); ++i) {
    const bool is_choice = space.variables[i].kind == Variable::Kind::kChoice;
    if (std::abs(unit_a[i] - unit_b[i]) >= kSameDesign || (is_choice && a[i] != b[i])) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool tells_noise(const Goal& goal, std::span<const Trial> trials) {
  const std::vector<Objective> objectives = objectives_of(goal);
  return std::ranges::any_of(trials, [&](const Trial& trial) {
    return is_judgeable(goal, trial) &&
           std::ranges::any_of(objectives, [&](const Objective& objective) {
             return objective_noise(objective, trial.outcome->scores) > 0.0;
           });
  });
}

Expectations expectations_of(const Goal& goal,
                             std::span<const int> told,
                             std::span<const std::vector<Expectation>> rows) {
  const std::vector<Objective> objectives = objectives_of(goal);
  Expectations expected;
  for (std::size_t i = 0; i < std::min(told.size(), rows.size()); ++i) {
    if (rows[i].empty()) {
      continue;
    }
    std::vector<Expectation> row = rows[i];
    for (std::size_t k = 0; k < row.size(); ++k) {
      row[k].mean *= objectives[k].is_maximised ? -1.0 : 1.0;
    }
    expected[told[i]] = std::move(row);
  }
  return expected;
}

std::vector<int> finalists_of(const Goal& goal,
                              const SearchSpace& space,
                              std::span<const Trial> trials,
                              const Expectations& expected,
                              int first,
                              std::size_t count) {
  std::vector<const Trial*> ordered;
  for (const Trial& trial : trials) {
    if (is_judgeable(goal, trial) && is_feasible(goal, trial.outcome->scores)) {
      ordered.push_back(&trial);
    }
  }
  std::ranges::stable_sort(ordered, {}, [&](const Trial* trial) {
    return std::pair(trial->number != first, expected_value(goal, *trial, expected));
  });
  std::vector<const Trial*> taken;
  for (const Trial* trial : ordered) {
    const bool is_new = std::ranges::none_of(
        taken, [&](const Trial* other) { return are_alike(space, trial->point, other->point); });
    if (is_new && taken.size() < count) {
      taken.push_back(trial);
    }
  }
  std::vector<int> numbers;
  std::ranges::transform(taken, std::back_inserter(numbers), &Trial::number);
  return numbers;
}

}  // namespace glint
