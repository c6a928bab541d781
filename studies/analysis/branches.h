// SPDX-License-Identifier: GPL-3.0-or-later
//
// The parts of a search space in which the same variables are active: values of a variable that
// conditions look at belong together where the same conditions hold with them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "optimizer/problem/space.h"

namespace glint {

struct Branch {
  /// "lighting_use = ring", "scan.positions other than 4"; empty where there is only one
  std::string name;
  std::vector<double> unit;       ///< of the whole space: its decisive values, 0.5 elsewhere
  std::vector<std::size_t> free;  ///< variables that are active and vary in it
  /// Of each free variable: the indices of its values that belong to the branch; empty: all.
  std::vector<std::vector<std::size_t>> values;

  /// From a cube with one coordinate for each free variable. @param free_unit  free.size() numbers
  Point point_at(const SearchSpace& space, std::span<const double> free_unit) const;
  /// The inverse. @param point  of the branch
  std::vector<double> unit_of(const SearchSpace& space, const Point& point) const;
  /// How many values free variable k can take here; infinity for floats without a step.
  double num_values_of(const SearchSpace& space, std::size_t k) const;
  /// Coordinates of free variable k at which point_at() gives its values here, each once, in their
  /// order. @param k  with finitely many values
  std::vector<double> units_of_values(const SearchSpace& space, std::size_t k) const;
};

/// Variables that conditions look at, in order.
std::vector<std::size_t> deciding_variables(const SearchSpace& space);

/// The names of the branches that canonical points lie in.
std::vector<std::string> branch_names(const SearchSpace& space, std::span<const Point> points);

/// One at least; in the order of the deciding values.
/// @param points  canonical ones: of a space with more than 256 branches only those are made that
///                one of them lies in
std::vector<Branch> branches_of(const SearchSpace& space, std::span<const Point> points = {});

}  // namespace glint
