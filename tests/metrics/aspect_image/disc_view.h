// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/units.h"
#include "metrics/aspect_image/roi.h"

namespace glint {

/// The first and one past the last pixel of [middle - reach, middle + reach] inside the image.
inline std::pair<int, int> span_of(double middle, double reach, int size) {
  const double first = std::clamp(std::floor(middle - reach), 0.0, size - 1.0);
  const double last = std::clamp(std::ceil(middle + reach), first + 1.0, static_cast<double>(size));
  return {static_cast<int>(first), static_cast<int>(last)};
}

/// The view of a round defect.
/// @param x_px, y_px    its middle; the centre of the first pixel is (0.5, 0.5)
/// @param radius_px     > 0, may be smaller than a pixel
/// @param window_radii  half width of the window, cut at the image's border
inline DefectView disc_view(std::string label,
                            double x_px,
                            double y_px,
                            double radius_px,
                            int width_px,
                            int height_px,
                            double window_radii = 5.0) {
  const auto [left, right] = span_of(x_px, window_radii * radius_px, width_px);
  const auto [top, bottom] = span_of(y_px, window_radii * radius_px, height_px);
  DefectView view{.label = std::move(label),
                  .left_px = left,
                  .top_px = top,
                  .distance = ImageF(right - left, bottom - top),
                  .area_px = kPi * radius_px * radius_px};
  for (int y = 0; y < view.distance.height(); ++y) {
    for (int x = 0; x < view.distance.width(); ++x) {
      const double dx = left + x + 0.5 - x_px;
      const double dy = top + y + 0.5 - y_px;
      view.distance(x, y) = static_cast<float>(std::hypot(dx, dy) / radius_px);
    }
  }
  return view;
}

}  // namespace glint
