// SPDX-License-Identifier: GPL-3.0-or-later
//
// How frames change with the width of the sensor's blur.
#pragma once

#include <vector>

#include "core/image/image.h"
#include "core/image/spans.h"
#include "simulator/sensor/sensor.h"

namespace glint {

/// How a blurred frame changes with the blur's sigma. A weight w at the distance k changes by
/// w (k^2 - m) / sigma^3, m the mean of k^2. So the sum with weights w_x w_y (k_x^2 + k_y^2) says
/// it, to the rounding of a sum; the difference of two blurs would have that over a short step.
class BlurDerivative {
 public:
  /// @param sensor, wanted, around  must outlive this object
  /// @param around  wanted pixels and those up to the blur's radius around
  BlurDerivative(const Sensor& sensor, const Spans& wanted, const Spans& around);

  /// The change of a number with these derivatives by blurred pixels.
  double derivative(const ImageF& radiance, const ImageF& blurred, const ImageF& by_blurred);

 private:
  void blur_rows(const ImageF& radiance);

  const std::vector<float>& weights_;
  const Spans& wanted_;
  const Spans& around_;
  std::vector<float> squares_;  ///< weights times squares of their distances
  double mean_square_ = 0.0;
  double per_cube_ = 0.0;
  ImageF across_, across_squares_;
  std::vector<float> padded_, row_;
};

}  // namespace glint
