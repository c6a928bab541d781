// SPDX-License-Identifier: GPL-3.0-or-later
//
// Shapes in a plane, and pictures of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/image/image.h"
#include "core/rng.h"
#include "core/units.h"

namespace glint::test {

/// Whether a point of the plane belongs to a shape of about unit size.
using Shape = std::function<bool(double, double)>;

struct Pose {
  double x_px = 0.0;
  double y_px = 0.0;
  double angle_rad = 0.0;
  double scale_px = 1.0;
};

/// The share of each pixel inside, by 8 x 8 points (at their places exact enough for 1e-4 of the
/// area) where a pixel is not clear.
template <class Inside>
ImageF rendered(const Inside& shape, const Pose& pose, int width, int height) {
  const double c = std::cos(pose.angle_rad) / pose.scale_px;
  const double s = std::sin(pose.angle_rad) / pose.scale_px;
  const auto holds = [&](double u, double v) {
    const double x = u - pose.x_px;
    const double y = v - pose.y_px;
    return shape(c * x + s * y, -s * x + c * y);
  };
  Mask corners(width + 1, height + 1);
  for (int y = 0; y <= height; ++y) {
    for (int x = 0; x <= width; ++x) {
      corners(x, y) = holds(x, y) ? 1 : 0;
    }
  }
  ImageF image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int inside =
          corners(x, y) + corners(x + 1, y) + corners(x, y + 1) + corners(x + 1, y + 1);
      int points = inside == 4 ? 64 : 0;
      for (int k = 0; k < 64 && inside % 4 != 0; ++k) {
        const int row = k / 8;
        points += holds(x + (k % 8 + 0.5) / 8.0, y + (row + 0.5) / 8.0) ? 1 : 0;
      }
      image(x, y) = static_cast<float>(points) / 64.0F;
    }
  }
  return image;
}

/// A smooth outline around the origin: r = 1 + sum of waves.
struct Outline {
  std::array<double, 5> size = {};
  std::array<double, 5> phase = {};
  double maximum = 0.0;  ///< of all waves together

  bool operator()(double x, double y) const {
    const double r = std::hypot(x, y);
    if (std::abs(r - 1.0) > maximum) {
      return r < 1.0;
    }
    const double angle = std::atan2(y, x);
    double edge = 1.0;
    for (std::size_t k = 0; k < size.size(); ++k) {
      edge += size[k] * std::cos((static_cast<double>(k) + 1.0) * angle - phase[k]);
    }
    return r <= edge;
  }
};

/// Waves of up to 0.25 at k = 2, less at higher ones; never below r = 0.3.
inline Outline random_outline(Rng& rng) {
  Outline outline;
  for (std::size_t k = 0; k < outline.size.size(); ++k) {
    const double maximum = k == 0 ? 0.1 : 0.5 / (static_cast<double>(k) + 1.0);
    outline.size[k] = 0.5 * maximum * rng.uniform();
    outline.phase[k] = rng.uniform(-kPi, kPi);
    outline.maximum += outline.size[k];
  }
  return outline;
}

inline Pose random_pose(Rng& rng) {
  return {.x_px = 100.0 + rng.uniform(-5.0, 5.0),
          .y_px = 95.0 + rng.uniform(-5.0, 5.0),
          .angle_rad = rng.uniform(-kPi, kPi),
          .scale_px = rng.uniform(35.0, 55.0)};
}

inline Mask thresholded(const ImageF& coverage) {
  Mask mask(coverage.width(), coverage.height());
  std::ranges::transform(coverage.values(), mask.values().begin(), [](float share) {
    return static_cast<unsigned char>(share >= 0.5F ? 1 : 0);
  });
  return mask;
}

}  // namespace glint::test
