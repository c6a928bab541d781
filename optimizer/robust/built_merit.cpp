// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/robust/built_merit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizer/algorithm/merit.h"
#include "optimizer/search/trade_off.h"

namespace glint {

BuiltMerit::BuiltMerit(const Goal& goal, std::span<const Trial> trials, const FrontRows& front)
    : goal_(goal), choice_(front_choice_of(goal)) {
  if (has_several_objectives(goal)) {
    const FrontRows rows = front.empty() ? trade_off(goal, trials, {}).front : front;
    ranges_ = rows.empty()
                  ? std::vector<ObjectiveRange>(static_cast<std::size_t>(num_objectives(goal)),
                                                {.best = 0.0, .width = 1.0})
                  : objective_ranges(rows);
  }
}

double BuiltMerit::of(const Scores& scores) const {
  if (!problem_with(goal_, scores).empty() || !is_feasible(goal_, scores)) {
    return kNoMerit;
  }
  return of_objectives(scores);
}

double BuiltMerit::of_objectives(const Scores& scores) const {
  const std::vector<double> objectives = minimised_objectives(goal_, scores);
  return ranges_.empty() ? objectives[0] : choice_cost(objectives, ranges_, choice_);
}

std::set<std::string> named_scores(const Goal& goal) {
  std::set<std::string> names;
  for (const Objective& objective : objectives_of(goal)) {
    names.insert(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    names.insert(constraint.name);
  }
  return names;
}

Standing standing_of(std::vector<double> merits) {
  const auto count = static_cast<double>(merits.size());
  const auto worse = static_cast<std::size_t>(std::lround(kWorstShare * (count - 1.0)));
  const auto place = merits.end() - 1 - static_cast<std::ptrdiff_t>(worse);
  std::ranges::nth_element(merits, place);
  const auto out = static_cast<int>(std::ranges::count(merits, kNoMerit));
  return {.too_many = std::max(0, out - static_cast<int>(worse)), .reached = *place};
}

}  // namespace glint
