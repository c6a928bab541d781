// SPDX-License-Identifier: GPL-3.0-or-later
//
// What an algorithm is told about a point: numbers and, for gradient methods, how they change.
#pragma once

#include <vector>

namespace glint {

/// What a model expects of a value without the noise of its evaluation.
struct Expectation {
  double mean = 0.0;
  double sd = 0.0;  ///< >= 0
};

/// A number and its derivative by each coordinate of the unit cube.
struct ValueWithGradient {
  double value = 0.0;
  std::vector<double> gradient;  ///< empty: not known
};

/// Smaller is better everywhere; all numbers are finite. Derivatives have one entry per coordinate,
/// 0 for those that cannot be varied continuously.
struct Answer {
  double merit = 0.0;           ///< penalties included: all that derivative-free methods look at
  bool is_failed = false;       ///< merit is made up then, and the rest is empty
  ValueWithGradient objective;  ///< without penalties
  /// One per limit of the goal (optimizer/algorithm/merit.h), at most 0 where it holds. A limit
  /// that holds and whose derivative is not known counts as constant.
  std::vector<ValueWithGradient> limits;
  std::vector<double> objectives;    ///< one per objective, without penalties; empty: objective
  std::vector<double> errors;        ///< standard errors of the objectives; empty: not known
  std::vector<double> limit_errors;  ///< of the limits, NaN where not known; empty: none is
};

}  // namespace glint
