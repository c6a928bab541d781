// SPDX-License-Identifier: GPL-3.0-or-later
//
// What rounding to the steps of a camera makes of grey values. Noise of half a step or more makes
// the mean of many pixels right; with less, all pixels of one brightness are rounded alike, and a
// signal below half a step is recorded as black. docs/theory/sensor.md, "Rounding".
#pragma once

#include "core/image/image.h"
#include "simulator/sensor/sensor.h"

namespace glint {

struct RoundedGrey {
  double mean = 0.0;
  double variance = 0.0;
};

/// Of a normal number that is cut to [0, 1] and rounded to multiples of a step.
/// @param mean       of the number, full scale 1
/// @param deviation  of the number, > 0; summed over six of them to both sides
/// @param step       > 0, a whole part of 1
RoundedGrey rounded_normal(double mean, double deviation, double step);

/// Standard deviation of a recorded grey value by shot, dark and read noise, before it is rounded;
/// 0 for a sensor without noise. @param grey  mean grey value, full scale 1, >= 0
double grey_noise(const SensorSettings& settings, double grey);

/// How much brighter pixels of a grey value are on average when they have been cut to [0, 1] and
/// rounded. At most half a step without noise.
/// @param deviation  of the noise, >= 0
double rounding_bias(double grey, double deviation, double step);

/// A bound of rounding_bias() over all grey values that lie six deviations above 0: half a step, or
/// step sum_k exp(-2 pi^2 k^2 n^2) / (pi k) with noise of n steps, whichever is less.
double largest_rounding_bias(double deviation, double step);

/// The step of the fewest bits, of 8, 10, 12, 14 and 16, of which all values of a picture are
/// multiples to a twentieth: 1 / (2^bits - 1). Pictures that are none's, as means of several, and
/// black ones: 16 bits'.
double recorded_step(const ImageF& picture);

}  // namespace glint
