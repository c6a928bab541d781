// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors of noisy pictures, and what renderers cost at equal errors.
#pragma once

#include <string>
#include <vector>

#include "core/image/image.h"
#include "tests/bench/peers/gear_pictures.h"

namespace glint::peers {

/// Root mean square difference from a reference over the mean of that, on the pixels of a mask.
struct RelativeError {
  double all = 0.0;
  double trimmed = 0.0;  ///< without the 0.1 % of pixels that differ most
};

RelativeError relative_error(const ImageF& picture, const ImageF& reference, const Mask& mask);

/// One renderer at one number of samples: means over the seeds.
struct GearPoint {
  int samples = 0;
  int pictures = 0;
  double cpu_s = 0.0;   ///< median
  RelativeError error;  ///< root of the mean square
};

std::vector<GearPoint> points_of(const std::vector<GearPicture>& pictures,
                                 const ImageF& reference,
                                 const Mask& mask);

/// Seconds until a renderer's error has come down to the given one: along the line between its
/// points in logarithms, continued beyond the ends.
double seconds_at_error(const std::vector<GearPoint>& points, double trimmed_error);

/// By how much the error falls per sample: the slope of log(error) over log(samples) from the first
/// to the last point; -0.5 is plain Monte Carlo.
double slope_of(const std::vector<GearPoint>& points);

/// How alike two references are.
struct Likeness {
  double mean_ratio = 0.0;   ///< of the second to the first
  double pixel_error = 0.0;  ///< relative, after the second is scaled to the first's mean
  double block_error = 0.0;  ///< the same of means over blocks of 8 x 8 px: without the noise
};

Likeness likeness(const ImageF& first, const ImageF& second, const Mask& mask);

}  // namespace glint::peers
