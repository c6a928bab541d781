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

/// `first`, feasible or not, then the feasible trials by what is expected of them.
std::vector<const Trial*> in_order(const Goal& goal,
                                   std::span<const Trial> trials,
                                   const Expectations& expected,
                                   int first,
                                   const LimitExpectations& limits) {
  std::vector<const Trial*> ordered;
  for (const Trial& trial : trials) {
    if (is_judgeable(goal, trial) &&
        (trial.number == first || is_likely_feasible(goal, trial, limits))) {
      ordered.push_back(&trial);
    }
  }
  std::ranges::stable_sort(ordered, {}, [&](const Trial* trial) {
    return std::pair(trial->number != first, expected_value(goal, *trial, expected));
  });
  return ordered;
}

/// Of each value of a choice that no taken design has, the first.
void add_missing_kinds(const std::vector<const Trial*>& ordered,
                       std::size_t choice,
                       std::vector<const Trial*>& taken) {
  for (const Trial* trial : ordered) {
    const auto is_of_kind = [&](const Trial* other) {
      return trial->point[choice] == other->point[choice];
    };
    if (std::ranges::none_of(taken, is_of_kind)) {
      taken.push_back(trial);
    }
  }
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

Expectations with_exact_scores(const Goal& goal,
                               std::span<const Trial> trials,
                               std::span<const std::string> names,
                               Expectations expected) {
  const std::vector<Objective> objectives = objectives_of(goal);
  for (auto& [number, row] : expected) {
    const Scores& seen = trials[static_cast<std::size_t>(number - 1)].outcome->scores;
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (std::ranges::find(names, objectives[k].name) != names.end()) {
        row[k] = {.mean = seen.at(objectives[k].name), .sd = 0.0};
      }
    }
  }
  return expected;
}

std::vector<int> finalists_of(const Goal& goal,
                              const SearchSpace& space,
                              std::span<const Trial> trials,
                              const Expectations& expected,
                              int first,
                              const FinalistPlaces& places,
                              const LimitExpectations& limits) {
  const std::vector<const Trial*> ordered = in_order(goal, trials, expected, first, limits);
  std::vector<const Trial*> taken;
  for (const Trial* trial : ordered) {
    const auto is_like = [&](const Trial* other) {
      return are_alike(space, trial->point, other->point);
    };
    if (taken.size() < places.count && std::ranges::none_of(taken, is_like)) {
      taken.push_back(trial);
    }
  }
  if (places.kinds) {
    add_missing_kinds(ordered, *places.kinds, taken);
  }
  std::vector<int> numbers;
  std::ranges::transform(taken, std::back_inserter(numbers), &Trial::number);
  return numbers;
}

}  // namespace glint
