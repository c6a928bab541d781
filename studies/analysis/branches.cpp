// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/branches.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"

namespace glint {
namespace {

constexpr double kMaxCombinations = 256;

std::string value_text(const Variable& variable, double value) {
  return variable.kind == Variable::Kind::kChoice
             ? variable.choices[static_cast<std::size_t>(value)]
             : shortest(value);
}

Branch branch_at(const SearchSpace& space,
                 const std::vector<std::size_t>& deciding,
                 const std::vector<double>& unit) {
  const Point point = point_from_unit(space, unit);
  Branch branch = {.name = branch_name(space, point), .unit = unit, .free = {}};
  for (std::size_t i = 0; i < space.variables.size(); ++i) {
    const bool decides = std::ranges::count(deciding, i) > 0;
    if (!decides && num_values(space.variables[i]) > 1.0 && is_active(space, point, i)) {
      branch.free.push_back(i);
    }
  }
  return branch;
}

/// How many values each deciding variable has. @throws ConfigError for too many in all
std::vector<std::size_t> counts_of(const SearchSpace& space,
                                   const std::vector<std::size_t>& deciding) {
  std::vector<std::size_t> counts;
  double all = 1.0;
  for (const std::size_t i : deciding) {
    all *= num_values(space.variables[i]);
    if (!(all <= kMaxCombinations)) {
      throw ConfigError(space.variables[i].name +
                        ": conditions look at more than 256 sets of values, too many to analyse "
                        "one by one");
    }
    counts.push_back(static_cast<std::size_t>(num_values(space.variables[i])));
  }
  return counts;
}

}  // namespace

Point Branch::point_at(const SearchSpace& space, std::span<const double> free_unit) const {
  std::vector<double> all = unit;
  for (std::size_t k = 0; k < free.size(); ++k) {
    all[free[k]] = free_unit[k];
  }
  return point_from_unit(space, all);
}

std::vector<double> Branch::unit_of(const SearchSpace& space, const Point& point) const {
  const std::vector<double> all = unit_from_point(space, point);
  std::vector<double> found;
  for (const std::size_t i : free) {
    found.push_back(all[i]);
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

std::string branch_name(const SearchSpace& space, const Point& point) {
  std::vector<std::string> parts;
  for (const std::size_t i : deciding_variables(space)) {
    if (is_active(space, point, i)) {
      const Variable& variable = space.variables[i];
      parts.push_back(variable.name + " = " + value_text(variable, point[i]));
    }
  }
  return join(parts, ", ");
}

std::vector<Branch> branches_of(const SearchSpace& space) {
  const std::vector<std::size_t> deciding = deciding_variables(space);
  const std::vector<std::size_t> counts = counts_of(space, deciding);
  std::size_t all = 1;
  for (const std::size_t count : counts) {
    all *= count;
  }
  std::vector<Branch> branches;
  for (std::size_t number = 0; number < all; ++number) {
    std::vector<double> unit(space.variables.size(), 0.5);
    std::size_t rest = number;
    for (std::size_t k = deciding.size(); k-- > 0;) {
      unit[deciding[k]] =
          (static_cast<double>(rest % counts[k]) + 0.5) / static_cast<double>(counts[k]);
      rest /= counts[k];
    }
    Branch branch = branch_at(space, deciding, unit);
    if (std::ranges::count(branches, branch.name, &Branch::name) == 0) {
      branches.push_back(std::move(branch));
    }
  }
  return branches;
}

}  // namespace glint
