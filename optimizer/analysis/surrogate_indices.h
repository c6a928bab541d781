// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the values of a fitted model owe to the coordinates of a cube, with what the model does not
// know.
//
// The indices of the model's mean come from a large design. How they spread comes from functions
// drawn from its posterior on a small one, each compared with the mean on the same rows (a control
// variate, so that the small design's own error falls out): value = index of the mean + average
// difference; the interval joins the spread of the differences with the bootstrap of the large
// design. After A. Marrel et al., "Calculations of Sobol indices for the Gaussian process
// metamodel", Reliab. Eng. Syst. Saf. 94, 2009, with joint draws instead of their integrals. The
// kernel's parameters are held; what they do not know is not in the intervals.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "optimizer/analysis/sobol_indices.h"
#include "optimizer/surrogate/gaussian_process.h"

namespace glint {

struct SurrogateSettings {
  SobolSettings of_mean = {.samples = 2048, .resamples = 100};
  int draws = 64;          ///< >= 2, functions from the posterior
  int max_points = 1536;   ///< of the small design; cost grows with the third power
  double coverage = 0.95;  ///< of the intervals, in (0, 1)
};

/// From the unit cube to the points of the model's space.
using CubeMap = std::function<Point(std::span<const double> unit)>;

/// One index for each coordinate, in order; all zero for a model without any variance.
/// @param model      fitted
/// @param dimension  of the cube, >= 1
/// @throws ConfigError for settings without a meaning
std::vector<SobolIndex> surrogate_indices(const GaussianProcess& model,
                                          const CubeMap& point_at,
                                          int dimension,
                                          const SurrogateSettings& settings = {});

}  // namespace glint
