// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_errors.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace glint {
namespace {

/// An error and what of it may be rounding.
struct ErrorKind {
  const char* name;
  double rounding;
};

constexpr std::array kErrorKinds = {
    ErrorKind{kFrameRmse, 1e-6}, ErrorKind{kHError, 1e-4}, ErrorKind{kContrastError, 1e-3}};

}  // namespace

std::optional<double> FrontierPoint::contrast_error_percent() const {
  std::optional<double> worst;
  for (const auto& [name, errors] : defects) {
    worst = std::max({worst.value_or(0.0), errors.weber_percent, errors.change_percent});
  }
  return worst;
}

std::optional<double> error_of(const FrontierPoint& point, const std::string& name) {
  if (!point.problem.empty()) {
    return std::nullopt;
  }
  if (name == kFrameRmse) {
    return point.frame_rmse;
  }
  return name == kHError ? std::optional(point.h_error_points) : point.contrast_error_percent();
}

std::optional<double> own_frame_rmse(double rmse_16, double rmse_64) {
  if (!(rmse_16 > rmse_64 && rmse_64 > 0.0)) {
    return std::nullopt;
  }
  const double q = (rmse_16 / rmse_64) * (rmse_16 / rmse_64);
  const double k_squared = 0.5 * (q + std::sqrt(q * q + 4.0 * (q - 1.0)));
  return rmse_64 / std::sqrt(1.0 + k_squared);
}

double rms_less_noise(double mean_square, double noise_square) {
  return std::sqrt(std::max(0.0, mean_square - noise_square));
}

void mark_front(std::vector<FrontierPoint>& points) {
  const auto visible_error = [](const FrontierPoint& point, const ErrorKind& kind) {
    const auto error = error_of(point, kind.name);
    return error ? std::optional(std::max(*error, kind.rounding)) : std::nullopt;
  };
  for (FrontierPoint& point : points) {
    point.on_front.clear();
    for (const ErrorKind& kind : kErrorKinds) {
      const auto error = visible_error(point, kind);
      const bool is_beaten = std::ranges::any_of(points, [&](const FrontierPoint& other) {
        const auto other_error = visible_error(other, kind);
        return !other.is_reference && other_error && other.cpu_s <= point.cpu_s && error &&
               (*other_error < *error || (*other_error == *error && other.cpu_s < point.cpu_s));
      });
      if (error && !is_beaten && !point.is_reference) {
        point.on_front.emplace_back(kind.name);
      }
    }
  }
}

ImageF enlarged(const ImageF& half, int width_px, int height_px) {
  ImageF full(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    // Centres: full pixel y lies at (y + 0.5) / 2 - 0.5 among those of the half picture.
    const int low_y = std::clamp((y + 1) / 2 - 1, 0, half.height() - 1);
    const int high_y = std::min((y + 1) / 2, half.height() - 1);
    const float at_y = y % 2 == 0 ? 0.75F : 0.25F;
    for (int x = 0; x < width_px; ++x) {
      const int low_x = std::clamp((x + 1) / 2 - 1, 0, half.width() - 1);
      const int high_x = std::min((x + 1) / 2, half.width() - 1);
      const float at_x = x % 2 == 0 ? 0.75F : 0.25F;
      const float low = half(low_x, low_y) + at_x * (half(high_x, low_y) - half(low_x, low_y));
      const float high = half(low_x, high_y) + at_x * (half(high_x, high_y) - half(low_x, high_y));
      full(x, y) = low + at_y * (high - low);
    }
  }
  return full;
}

}  // namespace glint
