// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>

#include "core/image/image.h"
#include "core/rng.h"

namespace glint {

/// Pixel means of `grey(x, y)` by 8 x 8 samples a pixel, points as in metrics/overlap.
template <class Grey>
ImageF drawn(int width_px, int height_px, const Grey& grey) {
  constexpr int kSamples = 8;
  ImageF picture(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      double sum = 0.0;
      for (int j = 0; j < kSamples; ++j) {
        for (int i = 0; i < kSamples; ++i) {
          sum += grey(x + (i + 0.5) / kSamples, y + (j + 0.5) / kSamples);
        }
      }
      picture(x, y) = static_cast<float>(sum / (kSamples * kSamples));
    }
  }
  return picture;
}

/// Grey 0.7 within and 0.1 beyond a circle, blurred with this standard deviation along the radius.
inline ImageF drawn_disc(int size_px, double x_px, double y_px, double radius_px, double blur_px) {
  return drawn(size_px, size_px, [=](double x, double y) {
    const double beyond = std::hypot(x - x_px, y - y_px) - radius_px;
    return 0.1 + 0.6 * 0.5 * std::erfc(beyond / (std::sqrt(2.0) * blur_px));
  });
}

inline void add_normal_noise(ImageF& picture, double deviation, std::uint64_t index) {
  Rng rng(3, Stream::kTest, index);
  for (float& grey : picture.values()) {
    grey += static_cast<float>(deviation * rng.normal());
  }
}

}  // namespace glint
