// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a number changes with the width sigma of the sensor's blur. The derivative of a convolution
// is one as well, with the derivatives of the weights along one axis and the weights along the
// other, summed over both.
// docs/theory/derivatives.md. Cost: two blurs of the pixels that count. Memory: two images.
#include "simulator/render/derivative/blur_derivative.h"

#include <algorithm>
#include <cstdlib>

#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/sensor/blur_kernel.h"

namespace glint {

BlurDerivative::BlurDerivative(const Sensor& sensor, const Spans& wanted, const Spans& around)
    : weights_(sensor.blur_weights()), wanted_(wanted), around_(around) {
  for (const double by_sigma : blur_kernel_derivative(sensor.settings().blur_px)) {
    derivatives_.push_back(static_cast<float>(by_sigma));
  }
}

double BlurDerivative::derivative(const ImageF& radiance, const ImageF& by_blurred) {
  blur_rows(radiance);
  const int radius = static_cast<int>(weights_.size()) - 1;
  double sum = 0.0;
  for (const RowSpan& span : wanted_) {
    row_.assign(static_cast<std::size_t>(span.size()), 0.0F);
    for (int k = -radius; k <= radius; ++k) {
      const auto at = static_cast<std::size_t>(std::abs(k));
      const int y = std::clamp(span.y + k, 0, radiance.height() - 1);
      gradient_kernels::add_scaled(
          across_derivatives_.row(y) + span.begin, span.size(), weights_[at], row_.data());
      gradient_kernels::add_scaled(
          across_.row(y) + span.begin, span.size(), derivatives_[at], row_.data());
    }
    const float* by = by_blurred.row(span.y) + span.begin;
    for (std::size_t i = 0; i < row_.size(); ++i) {
      sum += static_cast<double>(by[i] * row_[i]);
    }
  }
  return sum;
}

/// Along the rows, with the weights and with their derivatives.
void BlurDerivative::blur_rows(const ImageF& radiance) {
  if (across_.empty()) {
    across_ = ImageF(radiance.width(), radiance.height());
    across_derivatives_ = across_;
  }
  const int radius = static_cast<int>(weights_.size()) - 1;
  for (const RowSpan& span : around_) {
    padded_.resize(static_cast<std::size_t>(span.size() + 2 * radius));
    for (int i = 0; i < span.size() + 2 * radius; ++i) {
      const int x = std::clamp(span.begin + i - radius, 0, radiance.width() - 1);
      padded_[static_cast<std::size_t>(i)] = radiance(x, span.y);
    }
    float* plain = across_.row(span.y) + span.begin;
    float* derivatives = across_derivatives_.row(span.y) + span.begin;
    std::fill_n(plain, span.size(), 0.0F);
    std::fill_n(derivatives, span.size(), 0.0F);
    for (int k = -radius; k <= radius; ++k) {
      const auto at = static_cast<std::size_t>(std::abs(k));
      const float* from = padded_.data() + radius + k;
      gradient_kernels::add_scaled(from, span.size(), weights_[at], plain);
      gradient_kernels::add_scaled(from, span.size(), derivatives_[at], derivatives);
    }
  }
}

}  // namespace glint
