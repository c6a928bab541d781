// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the rule of a choice makes small, in ranges of the objectives that need not be those of the
// rows at hand: what is taken does not depend then on which rows happen to be there.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "optimizer/front/compromise.h"

namespace glint {

/// Where an objective's parts are 0, and how far it is from there to 1.
struct ObjectiveRange {
  double best = 0.0;
  double width = 0.0;  ///< >= 0
};

/// Of each objective over the rows. @param rows  all finite, at least one
std::vector<ObjectiveRange> objective_ranges(std::span<const std::vector<double>> rows);

/// In parts of the ranges; 0 where one has no width.
std::vector<double> parts_of(std::span<const double> row, std::span<const ObjectiveRange> ranges);

/// What the rule makes small: first the first number, of equal ones the second. Of rows that reach
/// every aspiration the first is 0, as which of them is taken is the knee's business.
/// @param row  finite
std::array<double, 2> choice_order(std::span<const double> row,
                                   std::span<const ObjectiveRange> ranges,
                                   const FrontChoice& choice);

/// As compromise_of() of compromise.h: the first row whose choice_order() is the smallest. What is
/// better than the best of a range counts as the best.
std::size_t compromise_of(std::span<const std::vector<double>> front,
                          std::span<const ObjectiveRange> ranges,
                          const FrontChoice& choice);

/// One number of any row: for the knee the distance to the best of all objectives, for weights the
/// weighted sum, for aspirations the largest weighted shortfall (negative where all are reached: by
/// how much). @param row  finite
double choice_cost(std::span<const double> row,
                   std::span<const ObjectiveRange> ranges,
                   const FrontChoice& choice);

}  // namespace glint
