// SPDX-License-Identifier: GPL-3.0-or-later
//
// The parts of a search space in which the same variables are active: one for each set of values
// of the variables that conditions look at.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "optimizer/problem/space.h"

namespace glint {

struct Branch {
  std::string name;               ///< "lighting_use = ring"; empty where there is only one
  std::vector<double> unit;       ///< of the whole space: its decisive values, 0.5 elsewhere
  std::vector<std::size_t> free;  ///< variables that are active in it, vary and do not decide

  /// From a cube with one coordinate for each free variable. @param free_unit  free.size() numbers
  Point point_at(const SearchSpace& space, std::span<const double> free_unit) const;
  /// The inverse.
  std::vector<double> unit_of(const SearchSpace& space, const Point& point) const;
};

/// Variables that conditions look at, in order.
std::vector<std::size_t> deciding_variables(const SearchSpace& space);

/// The name of the branch that a canonical point lies in.
std::string branch_name(const SearchSpace& space, const Point& point);

/// One at least; in the order of the deciding values.
/// @throws ConfigError for more than 256 sets of deciding values
std::vector<Branch> branches_of(const SearchSpace& space);

}  // namespace glint
