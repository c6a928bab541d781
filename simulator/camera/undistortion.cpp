// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/undistortion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace glint {
namespace {

constexpr double kOutside = std::numeric_limits<double>::quiet_NaN();

/// Weights of the pixels -1, 0, 1, 2 for a place between pixel 0 and 1.
std::array<double, 4> cubic_weights(double t) {
  return {t * (-0.5 + t * (1.0 - 0.5 * t)),
          1.0 + t * t * (-2.5 + 1.5 * t),
          t * (0.5 + t * (2.0 - 1.5 * t)),
          t * t * (-0.5 + 0.5 * t)};
}

float value_at(const ImageF& picture, double x_px, double y_px) {
  // Pixel i has its centre at i + 0.5.
  const double left = std::floor(x_px - 0.5);
  const double top = std::floor(y_px - 0.5);
  const std::array<double, 4> along_x = cubic_weights(x_px - 0.5 - left);
  const std::array<double, 4> along_y = cubic_weights(y_px - 0.5 - top);
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    const float* row =
        picture.row(std::clamp(static_cast<int>(top) + k - 1, 0, picture.height() - 1));
    double of_row = 0.0;
    for (int i = 0; i < 4; ++i) {
      of_row += along_x[static_cast<std::size_t>(i)] *
                static_cast<double>(
                    row[std::clamp(static_cast<int>(left) + i - 1, 0, picture.width() - 1)]);
    }
    sum += along_y[static_cast<std::size_t>(k)] * of_row;
  }
  return static_cast<float>(sum);
}

}  // namespace

Undistortion::Undistortion(const PinholeIntrinsics& camera, ThreadPool& pool)
    : width_px_(camera.width_px),
      height_px_(camera.height_px),
      x_px_(camera.width_px, camera.height_px),
      y_px_(camera.width_px, camera.height_px) {
  const PinholeCamera real(camera);
  const auto outside = pool.map<std::int64_t>(height_px_, [&](std::int64_t y) {
    std::int64_t count = 0;
    for (int x = 0; x < width_px_; ++x) {
      const Eigen::Vector2d pixel(x + 0.5, static_cast<double>(y) + 0.5);
      const Eigen::Vector2d ray = (pixel - camera.center_px).cwiseQuotient(camera.focal_px);
      const auto place = real.project({ray.x(), ray.y(), 1.0});
      const bool is_seen = place && place->x() >= 0.0 && place->y() >= 0.0 &&
                           place->x() <= width_px_ && place->y() <= height_px_;
      x_px_(x, static_cast<int>(y)) = is_seen ? place->x() : kOutside;
      y_px_(x, static_cast<int>(y)) = is_seen ? place->y() : kOutside;
      count += is_seen ? 0 : 1;
    }
    return count;
  });
  outside_share_ =
      static_cast<double>(std::accumulate(outside.begin(), outside.end(), std::int64_t{0})) /
      static_cast<double>(x_px_.size());
}

ImageF Undistortion::operator()(const ImageF& picture, ThreadPool& pool) const {
  GLINT_CHECK(picture.width() == width_px_ && picture.height() == height_px_,
              "the picture has the camera's size");
  ImageF result(width_px_, height_px_);
  pool.for_each(height_px_, [&](std::int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width_px_; ++x) {
      const double at = x_px_(x, y);
      result(x, y) = std::isnan(at) ? 0.0F : value_at(picture, at, y_px_(x, y));
    }
  });
  return result;
}

}  // namespace glint
