// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a number changes with the width sigma of the sensor's blur. The weight of a tap at the
// distance k changes by w (k^2 - mean of k^2) / sigma^3, so the derivative is a convolution as
// well, with weights k^2 w along one axis and w along the other, summed over both.
// docs/theory/derivatives.md. Cost: two blurs of the pixels that count. Memory: two images.
#include "simulator/render/derivative/blur_derivative.h"

#include <algorithm>
#include <cstdlib>

#include "simulator/render/derivative/gradient_kernels.h"

namespace glint {

BlurDerivative::BlurDerivative(const Sensor& sensor, const Spans& wanted, const Spans& around)
    : weights_(sensor.blur_weights()), wanted_(wanted), around_(around) {
  const double sigma = sensor.settings().blur_px;
  per_cube_ = 1.0 / (sigma * sigma * sigma);
  mean_square_ = sensor.blur_variance_px2();
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    squares_.push_back(static_cast<float>(k * k) * weights_[k]);
  }
}

double BlurDerivative::derivative(const ImageF& radiance,
                                  const ImageF& blurred,
                                  const ImageF& by_blurred) {
  blur_rows(radiance);
  const int radius = static_cast<int>(weights_.size()) - 1;
  const auto twice_mean = static_cast<float>(2.0 * mean_square_);
  double sum = 0.0;
  for (const RowSpan& span : wanted_) {
    row_.assign(static_cast<std::size_t>(span.size()), 0.0F);
    for (int k = -radius; k <= radius; ++k) {
      const auto at = static_cast<std::size_t>(std::abs(k));
      const int y = std::clamp(span.y + k, 0, radiance.height() - 1);
      gradient_kernels::add_scaled(
          across_squares_.row(y) + span.begin, span.size(), weights_[at], row_.data());
      gradient_kernels::add_scaled(
          across_.row(y) + span.begin, span.size(), squares_[at], row_.data());
    }
    const float* grey = blurred.row(span.y) + span.begin;
    const float* by = by_blurred.row(span.y) + span.begin;
    for (std::size_t i = 0; i < row_.size(); ++i) {
      sum += static_cast<double>(by[i] * (row_[i] - twice_mean * grey[i]));
    }
  }
  return sum * per_cube_;
}

/// Along the rows, with the weights and with their squares of distances.
void BlurDerivative::blur_rows(const ImageF& radiance) {
  if (across_.empty()) {
    across_ = ImageF(radiance.width(), radiance.height());
    across_squares_ = across_;
  }
  const int radius = static_cast<int>(weights_.size()) - 1;
  for (const RowSpan& span : around_) {
    padded_.resize(static_cast<std::size_t>(span.size() + 2 * radius));
    for (int i = 0; i < span.size() + 2 * radius; ++i) {
      const int x = std::clamp(span.begin + i - radius, 0, radiance.width() - 1);
      padded_[static_cast<std::size_t>(i)] = radiance(x, span.y);
    }
    float* plain = across_.row(span.y) + span.begin;
    float* squares = across_squares_.row(span.y) + span.begin;
    std::fill_n(plain, span.size(), 0.0F);
    std::fill_n(squares, span.size(), 0.0F);
    for (int k = -radius; k <= radius; ++k) {
      const auto at = static_cast<std::size_t>(std::abs(k));
      const float* from = padded_.data() + radius + k;
      gradient_kernels::add_scaled(from, span.size(), weights_[at], plain);
      gradient_kernels::add_scaled(from, span.size(), squares_[at], squares);
    }
  }
}

}  // namespace glint
