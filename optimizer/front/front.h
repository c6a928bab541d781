// SPDX-License-Identifier: GPL-3.0-or-later
//
// Designs with several objectives: which of them no other one beats in everything, and how much
// they are worth together. All objectives are minimised; rows hold one number per objective.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace glint {

/// a is nowhere worse than b and somewhere better.
bool dominates(std::span<const double> a, std::span<const double> b);

/// Indices, ascending, of the rows that no other row dominates; of equal rows the first. Rows with
/// a number that is not finite are left out.
std::vector<std::size_t> front_of(std::span<const std::vector<double>> rows);

/// Volume between the rows and the reference that at least one row dominates; rows that are not
/// better than the reference in every objective add nothing. 0 without rows. Exact (WFG: L. While,
/// L. Bradstreet and L. Barone, "A fast way of calculating exact hypervolumes", IEEE Trans. Evol.
/// Comput. 16, 2012).
double hypervolume(std::span<const std::vector<double>> rows, std::span<const double> reference);

/// What the hypervolume would lose without each row; 0 for rows that are not on the front, and for
/// rows that occur twice.
std::vector<double> hypervolume_contributions(std::span<const std::vector<double>> rows,
                                              std::span<const double> reference);

}  // namespace glint
