// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/branches.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/text.h"

namespace glint {
namespace {

constexpr double kMaxBranches = 256;
/// So many values are named one by one.
constexpr std::size_t kNamedValues = 3;

using Values = std::vector<std::size_t>;

/// A variable that conditions look at, and its values (by their index) in sets with which the same
/// conditions hold, in the order of their first value.
struct Decision {
  std::size_t variable = 0;
  std::vector<Values> sets;
  std::vector<std::string> names;  ///< of each set
};

std::size_t count_of(const Variable& variable) {
  return static_cast<std::size_t>(num_values(variable));
}

double middle_of_cell(std::size_t cell, std::size_t count) {
  return (static_cast<double>(cell) + 0.5) / static_cast<double>(count);
}

std::size_t cell_of_unit(double unit, std::size_t count) {
  const double cell = std::floor(unit * static_cast<double>(count));
  return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(count - 1)));
}

/// Between a value and the next one.
double step_between(const Variable& variable) {
  return variable.step > 0.0 ? variable.step : 1.0;
}

/// Where a value lies in the unit cube: logarithmic ones have cells of other widths.
double unit_of_value(const SearchSpace& space, std::size_t variable, std::size_t value) {
  const Variable& of = space.variables[variable];
  const auto index = static_cast<double>(value);
  Point point(space.variables.size(), 1.0);
  point[variable] = of.kind == Variable::Kind::kChoice ? index : of.low + index * step_between(of);
  return unit_from_point(space, point)[variable];
}

/// The index of the value that a point has.
std::size_t value_at(const SearchSpace& space, const Point& point, std::size_t variable) {
  const Variable& of = space.variables[variable];
  const double index = of.kind == Variable::Kind::kChoice
                           ? point[variable]
                           : (point[variable] - of.low) / step_between(of);
  const auto last = static_cast<double>(count_of(of) - 1);
  return static_cast<std::size_t>(std::clamp(std::round(index), 0.0, last));
}

/// A unit point at which the variable is active.
void activate(const SearchSpace& space, std::size_t variable, std::vector<double>& unit) {
  const std::string& parent = space.variables[variable].when_name;
  const auto found = std::ranges::find(space.variables, parent, &Variable::name);
  if (parent.empty() || found == space.variables.end()) {
    return;
  }
  const auto index = static_cast<std::size_t>(found - space.variables.begin());
  activate(space, index, unit);
  for (std::size_t value = 0; value < count_of(*found); ++value) {
    unit[index] = unit_of_value(space, index, value);
    if (is_active(space, point_from_unit(space, unit), variable)) {
      return;
    }
  }
}

/// Whether each variable that looks at this one is active with this value of it.
std::vector<bool> followers_with(const SearchSpace& space,
                                 std::vector<double> unit,
                                 std::size_t variable,
                                 std::size_t value) {
  unit[variable] = unit_of_value(space, variable, value);
  const Point point = point_from_unit(space, unit);
  std::vector<bool> active;
  for (std::size_t i = 0; i < space.variables.size(); ++i) {
    if (space.variables[i].when_name == space.variables[variable].name) {
      active.push_back(is_active(space, point, i));
    }
  }
  return active;
}

std::string texts_of(const SearchSpace& space, std::size_t variable, const Values& values) {
  const Variable& shown = space.variables[variable];
  std::vector<std::string> texts;
  for (const std::size_t value : values) {
    std::vector<double> unit(space.variables.size(), 0.5);
    activate(space, variable, unit);
    unit[variable] = unit_of_value(space, variable, value);
    texts.push_back(shown.kind == Variable::Kind::kChoice
                        ? shown.choices[value]
                        : shortest(point_from_unit(space, unit)[variable]));
  }
  return join(texts, " or ");
}

/// "n = 4", "n = 4 or 5"; of many values those that it has not: "n other than 4".
std::string set_name(const SearchSpace& space, std::size_t variable, const Values& set) {
  Values others;
  for (std::size_t value = 0; value < count_of(space.variables[variable]); ++value) {
    if (std::ranges::find(set, value) == set.end()) {
      others.push_back(value);
    }
  }
  const bool names_others = set.size() > kNamedValues && others.size() <= kNamedValues;
  return space.variables[variable].name + (names_others ? " other than " : " = ") +
         texts_of(space, variable, names_others ? others : set);
}

Decision decision_of(const SearchSpace& space, std::size_t variable) {
  std::vector<double> unit(space.variables.size(), 0.5);
  activate(space, variable, unit);
  Decision decision = {.variable = variable, .sets = {}, .names = {}};
  std::vector<std::vector<bool>> seen;
  for (std::size_t value = 0; value < count_of(space.variables[variable]); ++value) {
    const std::vector<bool> active = followers_with(space, unit, variable, value);
    const auto found = std::ranges::find(seen, active);
    if (found == seen.end()) {
      seen.push_back(active);
      decision.sets.push_back({value});
    } else {
      decision.sets[static_cast<std::size_t>(found - seen.begin())].push_back(value);
    }
  }
  for (const Values& set : decision.sets) {
    decision.names.push_back(set_name(space, variable, set));
  }
  return decision;
}

std::vector<Decision> decisions_of(const SearchSpace& space) {
  std::vector<Decision> decisions;
  for (const std::size_t variable : deciding_variables(space)) {
    decisions.push_back(decision_of(space, variable));
  }
  return decisions;
}

/// The index of the set that holds a value.
std::size_t set_with(const Decision& decision, std::size_t value) {
  const auto found = std::ranges::find_if(
      decision.sets, [&](const Values& set) { return std::ranges::find(set, value) != set.end(); });
  return static_cast<std::size_t>(found - decision.sets.begin());
}

std::string name_at(const SearchSpace& space,
                    const std::vector<Decision>& decisions,
                    const Point& point) {
  std::vector<std::string> parts;
  for (const Decision& decision : decisions) {
    if (decision.sets.size() > 1 && is_active(space, point, decision.variable)) {
      const std::size_t value = value_at(space, point, decision.variable);
      parts.push_back(decision.names[set_with(decision, value)]);
    }
  }
  return join(parts, ", ");
}

/// The branch that a canonical point lies in.
Branch branch_at(const SearchSpace& space,
                 const std::vector<Decision>& decisions,
                 const Point& point) {
  Branch branch = {.name = name_at(space, decisions, point),
                   .unit = std::vector<double>(space.variables.size(), 0.5),
                   .free = {},
                   .values = {}};
  for (std::size_t i = 0; i < space.variables.size(); ++i) {
    const auto decision = std::ranges::find(decisions, i, &Decision::variable);
    Values values;
    if (decision != decisions.end() && is_active(space, point, i)) {
      values = decision->sets[set_with(*decision, value_at(space, point, i))];
      branch.unit[i] = unit_of_value(space, i, values.front());
    }
    if (num_values(space.variables[i]) > 1.0 && values.size() != 1 && is_active(space, point, i)) {
      branch.free.push_back(i);
      branch.values.push_back(std::move(values));
    }
  }
  return branch;
}

/// A point of each set of decisions, or nothing for too many.
std::vector<Point> points_of_all(const SearchSpace& space, const std::vector<Decision>& decisions) {
  double count = 1.0;
  for (const Decision& decision : decisions) {
    count *= static_cast<double>(decision.sets.size());
  }
  std::vector<Point> points;
  for (std::size_t number = 0; count <= kMaxBranches && static_cast<double>(number) < count;
       ++number) {
    std::vector<double> unit(space.variables.size(), 0.5);
    std::size_t rest = number;
    for (std::size_t k = decisions.size(); k-- > 0;) {
      const std::vector<Values>& sets = decisions[k].sets;
      const std::size_t variable = decisions[k].variable;
      unit[variable] = unit_of_value(space, variable, sets[rest % sets.size()].front());
      rest /= sets.size();
    }
    points.push_back(point_from_unit(space, unit));
  }
  return points;
}

}  // namespace

double Branch::num_values_of(const SearchSpace& space, std::size_t k) const {
  return values[k].empty() ? num_values(space.variables[free[k]])
                           : static_cast<double>(values[k].size());
}

std::vector<double> Branch::units_of_values(const SearchSpace& space, std::size_t k) const {
  const auto count = static_cast<std::size_t>(num_values_of(space, k));
  std::vector<double> units;
  for (std::size_t value = 0; value < count; ++value) {
    units.push_back(values[k].empty() ? unit_of_value(space, free[k], value)
                                      : middle_of_cell(value, count));
  }
  return units;
}

Point Branch::point_at(const SearchSpace& space, std::span<const double> free_unit) const {
  std::vector<double> all = unit;
  for (std::size_t k = 0; k < free.size(); ++k) {
    all[free[k]] =
        values[k].empty()
            ? free_unit[k]
            : unit_of_value(
                  space, free[k], values[k][cell_of_unit(free_unit[k], values[k].size())]);
  }
  return point_from_unit(space, all);
}

std::vector<double> Branch::unit_of(const SearchSpace& space, const Point& point) const {
  const std::vector<double> all = unit_from_point(space, point);
  std::vector<double> found;
  for (std::size_t k = 0; k < free.size(); ++k) {
    found.push_back(all[free[k]]);
    if (!values[k].empty()) {
      const auto at = std::ranges::find(values[k], value_at(space, point, free[k]));
      const auto index = static_cast<std::size_t>(at - values[k].begin());
      found.back() = middle_of_cell(index, values[k].size());
    }
  }
  return found;
}

std::vector<std::size_t> deciding_variables(const SearchSpace& space) {
  std::vector<std::size_t> deciding;
  for (std::size_t i = 0; i < space.variables.size(); ++i) {
    if (std::ranges::count(space.variables, space.variables[i].name, &Variable::when_name) > 0) {
      deciding.push_back(i);
    }
  }
  return deciding;
}

std::vector<std::string> branch_names(const SearchSpace& space, std::span<const Point> points) {
  const std::vector<Decision> decisions = decisions_of(space);
  std::vector<std::string> names;
  for (const Point& point : points) {
    names.push_back(name_at(space, decisions, point));
  }
  return names;
}

std::vector<Branch> branches_of(const SearchSpace& space, std::span<const Point> points) {
  const std::vector<Decision> decisions = decisions_of(space);
  std::vector<Point> all = points_of_all(space, decisions);
  if (all.empty()) {
    std::ranges::copy(points, std::back_inserter(all));
  }
  if (all.empty()) {
    all.push_back(point_from_unit(space, std::vector<double>(space.variables.size(), 0.5)));
  }
  std::vector<Branch> branches;
  for (const Point& point : all) {
    Branch branch = branch_at(space, decisions, point);
    if (std::ranges::count(branches, branch.name, &Branch::name) == 0) {
      branches.push_back(std::move(branch));
    }
  }
  return branches;
}

}  // namespace glint
