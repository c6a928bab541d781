// SPDX-License-Identifier: GPL-3.0-or-later
//
// How frames change with the width of the sensor's blur.
#pragma once

#include <vector>

#include "core/image/image.h"
#include "core/image/spans.h"
#include "simulator/sensor/sensor.h"

namespace glint {

/// How a blurred frame changes with the blur's sigma. The sum with the derivatives of the weights
/// along one axis and the weights along the other, both ways, says it, to the rounding of a sum;
/// the difference of two blurs would have that over a short step.
class BlurDerivative {
 public:
  /// @param sensor, wanted, around  must outlive this object
  /// @param around  wanted pixels and those up to the blur's radius around
  BlurDerivative(const Sensor& sensor, const Spans& wanted, const Spans& around);

  /// The change of a number with these derivatives by blurred pixels.
  double derivative(const ImageF& radiance, const ImageF& by_blurred);

 private:
  void blur_rows(const ImageF& radiance);

  const std::vector<float>& weights_;
  const Spans& wanted_;
  const Spans& around_;
  std::vector<float> derivatives_;  ///< derivatives of the weights
  ImageF across_, across_derivatives_;
  std::vector<float> padded_, row_;
};

}  // namespace glint
