// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint {

/// Means up to here have tables.
inline constexpr double kLargestTabledMean = 30.0;

/// The smallest k with P(Poisson(mean) <= k) >= u, by adding up probabilities: mean / k of the last
/// one for each k.
/// @param mean  >= 0, up to 30
/// @param u     in (0, 1 - 2^-33]
int summed_poisson_quantile(double mean, double u);

/// The same number, found in tables where they leave no doubt.
int poisson_quantile(double mean, double u);

}  // namespace glint
