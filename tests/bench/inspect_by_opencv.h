// SPDX-License-Identifier: GPL-3.0-or-later
//
// The steps of the inspection in plain calls of OpenCV, what can be prepared prepared.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/image/image.h"

namespace glint {

struct OpenCvBlob {
  double x_px = 0.0;
  double y_px = 0.0;
  int area_px = 0;
  double weight = 0.0;
  double mu20 = 0.0;
  double mu11 = 0.0;
  double mu02 = 0.0;
};

class OpenCvInspector {
 public:
  /// @param threads  that OpenCV may take
  OpenCvInspector(
      int kernel_px, double sigma_px, const Mask& mask, const Mask& region, int threads);
  ~OpenCvInspector();

  /// Blobs of response >= threshold with two pixels or more.
  /// @param threshold  none: six robust standard deviations over the region
  std::vector<OpenCvBlob> inspect(const std::vector<Image<std::uint8_t>>& frames,
                                  std::optional<double> threshold);

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace glint
