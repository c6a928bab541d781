// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of a picture is even, and how much differs from pixel to pixel. Private to the room.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/image/image.h"

namespace glint::validate_detail {

/// The share of some pixels that lie in whole blocks of 3 x 3 of them.
class EvenCover {
 public:
  void add(const Mask& used) {
    Mask covered(used.width(), used.height());
    for (int y = 1; y + 1 < used.height(); ++y) {
      for (int x = 1; x + 1 < used.width(); ++x) {
        cover_block(used, x, y, covered);
      }
    }
    const auto count = [](const Mask& mask) {
      return static_cast<double>(
          std::ranges::count_if(mask.values(), [](auto pixel) { return pixel != 0; }));
    };
    pixels_ += count(used);
    covered_ += count(covered);
  }

  /// 0 without any pixel.
  double share() const { return covered_ / std::max(1.0, pixels_); }

 private:
  static void cover_block(const Mask& used, int x, int y, Mask& covered) {
    for (int k = 0; k < 9; ++k) {
      if (used(x + k % 3 - 1, y + k / 3 - 1) == 0) {
        return;
      }
    }
    for (int k = 0; k < 9; ++k) {
      covered(x + k % 3 - 1, y + k / 3 - 1) = 1;
    }
  }

  double pixels_ = 0.0;
  double covered_ = 0.0;
};

/// Squares of means over 3 x 3 pixels, and of differences of neighbours.
struct EvenSums {
  /// Of independent noise: means of 3 x 3 overlap, 2 (19 / 9)^2, and the noise is estimated,
  /// about 4.
  static constexpr double kScatter = 13.0;

  double squares = 0.0;
  double count = 0.0;
  double steps = 0.0;       ///< to the next pixel
  double wide_steps = 0.0;  ///< to the next but one

  void add(const ImageF& values, const Mask& used) {
    for (int y = 1; y + 1 < values.height(); ++y) {
      for (int x = 1; x + 1 < values.width(); ++x) {
        add_pixel(values, used, x, y);
      }
    }
  }

  void add_pixel(const ImageF& values, const Mask& used, int x, int y) {
    double sum = 0.0;
    int pixels = 0;
    for (int k = 0; k < 9; ++k) {
      pixels += used(x + k % 3 - 1, y + k / 3 - 1);
      sum += static_cast<double>(values(x + k % 3 - 1, y + k / 3 - 1));
    }
    if (pixels != 9) {
      return;
    }
    const double step = static_cast<double>(values(x, y) - values(x + 1, y));
    const double wide = static_cast<double>(values(x - 1, y) - values(x + 1, y));
    squares += sum * sum / 81.0;
    steps += step * step;
    wide_steps += wide * wide;
    count += 1.0;
  }

  /// Noise of a pixel has half the variance of a wide step; neighbours whose noise is correlated by
  /// r differ less, and leave more of it in a mean of nine: (1 + 24 r / 9 + 16 r^2 / 9) / 9. What
  /// that noise leaves of squares of n means is known to sqrt(kScatter / n) of it.
  /// @param sigmas  so many of these standard errors are no difference
  double rms(double sigmas) const {
    if (count <= 0.0 || wide_steps <= 0.0) {
      return 0.0;
    }
    const double alike = std::clamp(1.0 - steps / wide_steps, 0.0, 0.5);
    const double noise =
        wide_steps / 18.0 * (1.0 + 24.0 / 9.0 * alike + 16.0 / 9.0 * alike * alike);
    const double unsure = sigmas * noise * std::sqrt(kScatter / count);
    return std::sqrt(std::max(0.0, squares - noise - unsure) / count);
  }
};

}  // namespace glint::validate_detail
