// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "metrics/scores.h"
#include "optimizer/problem/goal.h"

namespace glint {

/// What a search minimises, for each objective and design: [objective][design]. Of one objective
/// the limits count as in a search: three times the spread of the designs for each unit of
/// log(1 + violation).
std::vector<std::vector<double>> search_figures(const Goal& goal, std::span<const Scores> designs);

/// Their standard errors: those of the objective and, where the limits count, of the penalties, as
/// if they were independent. At least rounding: a millionth of the spread of the figures and 1e-12
/// of the largest, within which designs are tied.
std::vector<std::vector<double>> search_figure_errors(const Goal& goal,
                                                      std::span<const Scores> designs);

}  // namespace glint
