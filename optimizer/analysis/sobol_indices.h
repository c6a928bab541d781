// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a function over the unit cube owes to each of its coordinates.
//
// The first-order index is the share of the variance that a coordinate explains alone; the total
// index is the share that is lost when all others are held, with every interaction. For an additive
// function both are the same and sum to 1. Estimated from two designs A and B of a Sobol sequence:
// first order by A. Saltelli et al., "Variance based sensitivity analysis of model output", Comput.
// Phys. Commun. 181, 2010, table 2 (b); total by M. Jansen, Comput. Phys. Commun. 117, 1999.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace glint {

/// A share of the variance with its interval. Estimates may fall slightly outside [0, 1].
struct VarianceShare {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

struct SobolIndex {
  VarianceShare first;
  VarianceShare total;
};

struct SobolSettings {
  int samples = 4096;   ///< rows of a design; the function is asked samples * (dimension + 2) times
  int resamples = 200;  ///< bootstrap resamples of the rows, for the intervals
  double coverage = 0.95;  ///< of the intervals, in (0, 1)
  std::uint64_t seed = 1;
};

/// A function over [0, 1]^dimension.
using CubeFunction = std::function<double(std::span<const double> unit)>;

/// One index for each coordinate, in order; all zero for a constant function. The intervals are
/// those of this estimate: what a surrogate does not know is not in them.
/// @throws ConfigError for a dimension or settings without a meaning
std::vector<SobolIndex> sobol_indices(const CubeFunction& function,
                                      int dimension,
                                      const SobolSettings& settings = {});

}  // namespace glint
