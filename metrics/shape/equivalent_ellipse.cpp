// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/shape/equivalent_ellipse.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/units.h"

namespace glint {
namespace {

/// Sums of weight x^p y^q about a point.
struct RawMoments {
  double w = 0.0;
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double xxx = 0.0;
  double xxy = 0.0;
  double xyy = 0.0;
  double yyy = 0.0;

  /// Adds a row at height y with sums of weight x^p.
  void add_row(double at_y, const std::array<double, 4>& row) {
    w += row[0];
    x += row[1];
    y += at_y * row[0];
    xx += row[2];
    xy += at_y * row[1];
    yy += at_y * at_y * row[0];
    xxx += row[3];
    xxy += at_y * row[2];
    xyy += at_y * at_y * row[1];
    yyy += at_y * at_y * at_y * row[0];
  }
};

/// About the picture's middle: small numbers lose less when the centre is taken off.
template <class T>
RawMoments raw_moments(const Image<T>& weights) {
  const double middle_x = 0.5 * weights.width();
  const double middle_y = 0.5 * weights.height();
  RawMoments raw;
  for (int y = 0; y < weights.height(); ++y) {
    std::array<double, 4> row = {};
    for (int x = 0; x < weights.width(); ++x) {
      const auto w = static_cast<double>(weights(x, y));
      const double at_x = x + 0.5 - middle_x;
      row[0] += w;
      row[1] += w * at_x;
      row[2] += w * at_x * at_x;
      row[3] += w * at_x * at_x * at_x;
    }
    raw.add_row(y + 0.5 - middle_y, row);
  }
  return raw;
}

ShapeMoments central(const RawMoments& raw, double middle_x, double middle_y) {
  const double x = raw.x / raw.w;
  const double y = raw.y / raw.w;
  const double xx = raw.xx / raw.w;
  const double xy = raw.xy / raw.w;
  const double yy = raw.yy / raw.w;
  constexpr double kPixelExtent = 1.0 / 12.0;
  ShapeMoments m;
  m.area_px = raw.w;
  m.x_px = middle_x + x;
  m.y_px = middle_y + y;
  m.xx = xx - x * x + kPixelExtent;
  m.xy = xy - x * y;
  m.yy = yy - y * y + kPixelExtent;
  m.xxx = raw.xxx / raw.w - 3.0 * x * xx + 2.0 * x * x * x;
  m.xxy = raw.xxy / raw.w - 2.0 * x * xy - y * xx + 2.0 * x * x * y;
  m.xyy = raw.xyy / raw.w - 2.0 * y * xy - x * yy + 2.0 * x * y * y;
  m.yyy = raw.yyy / raw.w - 3.0 * y * yy + 2.0 * y * y * y;
  return m;
}

}  // namespace

std::optional<ShapeMoments> moments_of(const ImageF& weights) {
  const bool is_sound =
      std::ranges::all_of(weights.values(), [](float w) { return w >= 0.0F && std::isfinite(w); });
  if (!is_sound) {
    throw ConfigError("moments: the picture holds NaN, infinity or negative values");
  }
  const RawMoments raw = raw_moments(weights);
  if (!(raw.w > 0.0)) {
    return std::nullopt;
  }
  return central(raw, 0.5 * weights.width(), 0.5 * weights.height());
}

std::optional<ShapeMoments> moments_of(const Mask& mask) {
  return moments_of(coverage_of(mask));
}

EquivalentEllipse ellipse_of(const ShapeMoments& m) {
  const double mean = 0.5 * (m.xx + m.yy);
  const double spread = std::hypot(0.5 * (m.xx - m.yy), m.xy);
  const double angle = 0.5 * std::atan2(2.0 * m.xy, m.xx - m.yy);
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double third =
      c * c * c * m.xxx + 3.0 * c * c * s * m.xxy + 3.0 * c * s * s * m.xyy + s * s * s * m.yyy;
  EquivalentEllipse ellipse;
  ellipse.x_px = m.x_px;
  ellipse.y_px = m.y_px;
  ellipse.length_px = 4.0 * std::sqrt(mean + spread);
  ellipse.width_px = 4.0 * std::sqrt(std::max(mean - spread, 0.0));
  ellipse.angle_rad = angle > -0.5 * kPi ? angle : 0.5 * kPi;
  ellipse.elongation = spread / mean;
  ellipse.skewness = third / std::pow(mean + spread, 1.5);
  return ellipse;
}

ImageF coverage_of(const Mask& mask) {
  ImageF coverage(mask.width(), mask.height());
  std::ranges::transform(mask.values(), coverage.values().begin(), [](unsigned char inside) {
    return inside != 0 ? 1.0F : 0.0F;
  });
  return coverage;
}

}  // namespace glint
