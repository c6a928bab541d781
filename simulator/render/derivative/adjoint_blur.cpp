// SPDX-License-Identifier: GPL-3.0-or-later
//
// The adjoint of the sensor's blur: from the derivatives of a number by blurred pixels to those by
// radiances. A symmetric kernel is its own transpose inside the picture; a pixel of the border also
// collects the weights of everything beyond, for which the blur took it. Separable, down the
// columns and then along the rows, by the sensor's own inner loops. docs/theory/derivatives.md,
// "Frames". Cost: that of the blur itself; memory for one row.
#include "simulator/render/derivative/adjoint_blur.h"

#include <algorithm>
#include <cstdlib>

#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/sensor/sensor_kernels.h"

namespace glint {

AdjointBlur::AdjointBlur(const Sensor& sensor, int width, int height)
    : weights_(sensor.blur_weights()),
      radius_(sensor.blur_radius_px()),
      width_(width),
      height_(height),
      beyond_(weights_.size()),
      line_(static_cast<std::size_t>(width + 2 * radius_)),
      zeros_(static_cast<std::size_t>(width)),
      low_(static_cast<std::size_t>(radius_)),
      high_(static_cast<std::size_t>(radius_)) {
  for (std::size_t k = beyond_.size() - 1; k > 0; --k) {
    beyond_[k - 1] = beyond_[k] + weights_[k];
  }
}

/// Share of the light of pixel `to` that pixel `from` of a line gets: that of the border's pixels
/// is also that of all beyond.
float AdjointBlur::weight_of(int from, int to, int size) const {
  const auto at = static_cast<std::size_t>(std::abs(to - from));
  float weight = at < weights_.size() ? weights_[at] : 0.0F;
  const auto left = static_cast<std::size_t>(from);
  const auto right = static_cast<std::size_t>(size - 1 - from);
  weight += to == 0 && left < beyond_.size() ? beyond_[left] : 0.0F;
  weight += to == size - 1 && right < beyond_.size() ? beyond_[right] : 0.0F;
  return weight;
}

void AdjointBlur::blur_columns(const ImageF& by_blurred, int y, int low, int high) {
  float* line = line_.data() + radius_ + low;
  if (y > 0 && y < height_ - 1) {
    for (int k = 1; k <= radius_; ++k) {
      const auto at = static_cast<std::size_t>(k - 1);
      low_[at] = (y - k >= 0 ? by_blurred.row(y - k) : zeros_.data()) + low;
      high_[at] = (y + k < height_ ? by_blurred.row(y + k) : zeros_.data()) + low;
    }
    sensor_kernels::weigh_rows({.centre = by_blurred.row(y) + low,
                                .low = low_.data(),
                                .high = high_.data(),
                                .weights = weights_.data(),
                                .radius = radius_},
                               high - low,
                               line);
    return;
  }
  std::fill_n(line, high - low, 0.0F);
  for (int from = std::max(0, y - radius_); from <= std::min(height_ - 1, y + radius_); ++from) {
    gradient_kernels::add_scaled(
        by_blurred.row(from) + low, high - low, weight_of(from, y, height_), line);
  }
}

void AdjointBlur::apply(const ImageF& by_blurred, const RowSpan& span, float* out) {
  const int low = std::max(0, span.begin - radius_);
  const int high = std::min(width_, span.end + radius_);
  blur_columns(by_blurred, span.y, low, high);
  const float* line = line_.data() + radius_;
  for (int k = 1; k <= radius_; ++k) {
    const auto at = static_cast<std::size_t>(k - 1);
    low_[at] = line + span.begin - k;
    high_[at] = line + span.begin + k;
  }
  sensor_kernels::weigh_rows({.centre = line + span.begin,
                              .low = low_.data(),
                              .high = high_.data(),
                              .weights = weights_.data(),
                              .radius = radius_},
                             span.size(),
                             out);
  for (const int x : {0, width_ - 1}) {
    if (x < span.begin || x >= span.end) {
      continue;
    }
    float sum = 0.0F;
    for (int from = std::max(0, x - radius_); from <= std::min(width_ - 1, x + radius_); ++from) {
      sum += weight_of(from, x, width_) * line[from];
    }
    out[x - span.begin] = sum;
  }
}

}  // namespace glint
