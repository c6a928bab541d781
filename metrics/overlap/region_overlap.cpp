// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/region_overlap.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

/// @param share  of a pixel's value
template <class T, class Share>
RegionOverlap overlap_by(const Image<T>& first, const Image<T>& second, const Share& share) {
  if (first.width() != second.width() || first.height() != second.height()) {
    throw ConfigError(fmt::format("overlap: the regions have {} x {} and {} x {} pixels",
                                  first.width(),
                                  first.height(),
                                  second.width(),
                                  second.height()));
  }
  RegionOverlap overlap;
  double both = 0.0;
  double either = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double a = share(first.values()[i]);
    const double b = share(second.values()[i]);
    overlap.first_px += a;
    overlap.second_px += b;
    both += std::min(a, b);
    either += std::max(a, b);
  }
  if (either > 0.0) {
    overlap.iou = both / either;
    overlap.dice = 2.0 * both / (overlap.first_px + overlap.second_px);
  }
  return overlap;
}

}  // namespace

RegionOverlap overlap_of(const Mask& first, const Mask& second) {
  return overlap_by(first, second, [](unsigned char is_in) { return is_in != 0 ? 1.0 : 0.0; });
}

RegionOverlap overlap_of(const ImageF& first, const ImageF& second) {
  return overlap_by(first, second, [](float share) { return static_cast<double>(share); });
}

Mask pixels_on_both(const ImageF& own, const ImageF& other, const Eigen::Affine2d& to_other) {
  constexpr double kWholly = 0.999;
  constexpr std::ptrdiff_t kMinPixels = 100;
  Mask region(own.width(), own.height());
  for (int y = 0; y < own.height(); ++y) {
    for (int x = 0; x < own.width(); ++x) {
      const bool is_on = static_cast<double>(own(x, y)) >= kWholly &&
                         value_under(other, to_other, x, y) >= kWholly;
      region(x, y) = is_on ? 1 : 0;
    }
  }
  return std::ranges::count(region.values(), 1) >= kMinPixels ? region : Mask();
}

}  // namespace glint
