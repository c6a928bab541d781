// SPDX-License-Identifier: GPL-3.0-or-later
//
// The search space: what may be varied, and the map between the unit cube, in which algorithms
// think, and the variables' own units, in which designs are evaluated, stored and told.
//
// Values are rounded here, before the evaluation and before the merit is told, and inactive
// variables are set to their middle: equal designs are equal points, bit for bit.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace glint {

/// One thing that may be varied.
struct Variable {
  enum class Kind { kFloat, kInteger, kChoice };

  std::string name;
  Kind kind = Kind::kFloat;
  double low = 0.0;                  ///< not used by kChoice
  double high = 1.0;                 ///< >= low; equal means a constant
  bool is_log = false;               ///< spread evenly in the logarithm; needs low > 0
  double step = 0.0;                 ///< > 0: values are low + k * step; 0: any (integers: 1)
  std::vector<std::string> choices;  ///< kChoice: the value is the index
  /// Active only while the variable of this name has this value (a choice, or a number as text);
  /// both empty: always active.
  std::string when_name;
  std::string when_value;
  std::vector<std::string> when_others;  ///< further values of that variable that do as well
};

struct SearchSpace {
  std::vector<Variable> variables;
};

/// One value per variable, in the variable's own unit (choices as index).
using Point = std::vector<double>;

/// @throws ConfigError with one line per problem: empty or repeated names, min above max, limits
///         that are not finite, log with low <= 0, integers without whole limits, a step that is
///         negative or larger than the range, no or repeated choices, a condition on an unknown
///         variable, on itself, in a circle, or on a value that cannot occur.
void check(const SearchSpace& space);

/// From the unit cube to values: log scaling, rounding, inactive variables to their middle.
/// @param unit  one number per variable; outside [0, 1] is clamped, NaN is the middle
Point point_from_unit(const SearchSpace& space, std::span<const double> unit);

/// The inverse of point_from_unit up to rounding (discrete values give the middle of their cell).
std::vector<double> unit_from_point(const SearchSpace& space, std::span<const double> point);

/// The nearest point that the space allows; a point it allows stays as it is, bit for bit.
Point canonical(const SearchSpace& space, std::span<const double> point);

/// Whether the variable's `when` (and that of the variable it looks at) holds at this point.
bool is_active(const SearchSpace& space, std::span<const double> point, std::size_t index);

/// d(value) / d(unit coordinate) of this variable at a canonical point; 0 where the variable cannot
/// be varied smoothly: choices, integers, stepped floats, constants, inactive ones.
double derivative_at(const SearchSpace& space, std::span<const double> point, std::size_t index);

/// Floats are continuous, also with a step; integers and choices are discrete.
bool is_continuous(const Variable& variable);

/// How many values the variable can take; infinity for floats without a step.
double num_values(const Variable& variable);

}  // namespace glint
