// SPDX-License-Identifier: GPL-3.0-or-later
//
// The adjoint of the sensor's blur: from derivatives by blurred pixels to those by radiances.
#pragma once

#include <vector>

#include "core/image/image.h"
#include "core/image/spans.h"
#include "simulator/sensor/sensor.h"

namespace glint {

/// Not to be shared between threads.
class AdjointBlur {
 public:
  /// @param sensor  must outlive this object
  AdjointBlur(const Sensor& sensor, int width, int height);

  /// @param by_blurred  0 wherever no blurred pixel is wanted
  /// @param out         span.size() derivatives
  void apply(const ImageF& by_blurred, const RowSpan& span, float* out);

 private:
  float weight_of(int from, int to, int size) const;
  void blur_columns(const ImageF& by_blurred, int y, int low, int high);

  const std::vector<float>& weights_;
  int radius_;
  int width_;
  int height_;
  std::vector<float> beyond_;  ///< k: the weights at k + 1 and further together
  std::vector<float> line_;    ///< a row, with zeros on both sides
  std::vector<float> zeros_;
  std::vector<const float*> low_, high_;
};

}  // namespace glint
