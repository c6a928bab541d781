// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the places that rays meet to grey values: stripes tested at each place, frame by frame; a
// Gaussian over the film; the mean over each pixel; exposure, shot noise in expectation (sums over
// Poisson probabilities), clipping and rounding. Then h and the change by a dent, by their
// definitions (docs/theory/homogeneity.md, visibility.md).
#pragma once

#include <vector>

#include "studies/stability/reference/reference_rays.h"

namespace glint::stability {

/// A frame or the mean of all: expectation and variance of each pixel, row by row.
struct ReferenceImage {
  std::vector<double> mean;
  std::vector<double> variance;  ///< by shot noise
};

/// Radiance of each pixel behind the blur, row by row, with the tunnel moved to a position.
/// @param position  0 to wall.positions - 1
std::vector<double> reference_radiance(const ReferenceScene& scene,
                                       const ReferenceRays& rays,
                                       int position);

/// Grey value that the sensor makes of a radiance, in expectation, and its variance.
std::array<double, 2> expected_grey(const SensorSettings& sensor, double radiance);

struct ReferenceScores {
  double h_rms = 0.0;
  double mean = 0.0;           ///< over the region, of full scale
  std::vector<double> change;  ///< of each dent, of full scale
  ReferenceImage aspect;       ///< mean of the frames
  std::vector<char> region;    ///< 1: counts for h
};

/// @throws ConfigError when no pixel is left to score
ReferenceScores reference_scores(const ReferenceScene& scene, const RaySampling& sampling);

}  // namespace glint::stability
