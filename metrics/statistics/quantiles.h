// SPDX-License-Identifier: GPL-3.0-or-later
//
// Distributions that intervals are made from. Formulas and sources: docs/theory/statistics.md.
#pragma once

namespace glint {

/// Standard normal distribution. @param probability  in (0, 1)
double normal_cdf(double x);
double normal_quantile(double probability);

/// Standard logistic distribution, the inverse of ln(p / (1 - p)).
double logistic(double x);

/// Of Student's t with so many degrees of freedom (>= 1). @param probability  in (0, 1)
double t_quantile(double probability, double freedom);

/// Of the noncentral t distribution: (z + shift) / sqrt(chi-square / freedom).
/// @param probability  in (0, 1)  @param freedom  >= 1
double noncentral_t_quantile(double probability, double freedom, double shift);

/// Of the gamma distribution with scale 1 (twice it: chi-square with twice the shape degrees of
/// freedom). @param probability  in (0, 1)  @param shape  > 0
double gamma_quantile(double probability, double shape);

}  // namespace glint
