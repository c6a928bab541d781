// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/compared_picture.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/image/image_io.h"
#include "core/image/picture_orientation.h"

namespace glint {
namespace {

/// Floats above full scale are radiances: the brightest thousandth is taken as full scale.
void scale_floats(ImageF& grey) {
  std::vector<float> values(grey.values().begin(), grey.values().end());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 999 / 1000);
  std::nth_element(values.begin(), at, values.end());
  const float full = *at > 0.0F ? *at : *std::ranges::max_element(values);
  if (full <= 0.0F) {
    return;
  }
  for (float& value : grey.values()) {
    value = std::min(value / full, 1.0F);
  }
}

/// Variance of one pixel, from differences along rows between every second pixel: those of
/// neighbours may be correlated by the sensor's interpolation.
double noise_variance(const ImageF& grey) {
  double sum = 0.0;
  double count = 0.0;
  for (int y = 0; y < grey.height(); ++y) {
    for (int x = 2; x < grey.width(); ++x) {
      const double change = static_cast<double>(grey(x, y)) - static_cast<double>(grey(x - 2, y));
      sum += 0.5 * change * change;
      count += 1.0;
    }
  }
  return sum / std::max(count, 1.0);
}

/// Variance of the means of whole blocks.
double block_variance(const ImageF& grey, int block_px) {
  const ImageF means = reduce(grey, block_px);
  double sum = 0.0;
  double squares = 0.0;
  for (const float mean : means.values()) {
    sum += static_cast<double>(mean);
    squares += static_cast<double>(mean) * static_cast<double>(mean);
  }
  const auto count = static_cast<double>(means.size());
  return (squares - sum * sum / count) / std::max(count - 1.0, 1.0);
}

}  // namespace

bool is_dark_noise(const ImageF& grey) {
  constexpr double kDark = 0.05;
  constexpr int kNoiseBlockPx = 16;
  const double mean = std::accumulate(grey.values().begin(), grey.values().end(), 0.0) /
                      static_cast<double>(std::max<std::size_t>(grey.size(), 1));
  if (mean >= kDark || std::min(grey.width(), grey.height()) < 4 * kNoiseBlockPx) {
    return false;
  }
  const double blocks = block_variance(grey, kNoiseBlockPx) * kNoiseBlockPx * kNoiseBlockPx;
  const double count = static_cast<double>(grey.size()) / (kNoiseBlockPx * kNoiseBlockPx);
  return blocks < noise_variance(grey) * (1.0 + 4.0 * std::sqrt(2.0 / count));
}

bool is_bright_noise(const ImageF& grey) {
  ImageF rest = grey;
  for (float& value : rest.values()) {
    value = 1.0F - value;
  }
  return is_dark_noise(rest);
}

bool is_plain(const ImageF& grey) {
  const auto [low, high] = std::ranges::minmax_element(grey.values());
  return *high - *low <= 0.0F;
}

ComparedPicture read_compared(const CompareSource& source, bool may_be_plain) {
  const std::string name = source.picture.string();
  const Picture picture = read_picture(source.picture);
  ComparedPicture result = {.source = source,
                            .grey = linear_values(picture.pixels),
                            .bits = picture.bits,
                            .is_float = picture.is_float,
                            .channels = picture.channels,
                            .orientation = picture_orientation(source.picture)};
  const auto& values = result.grey.values();
  if (!std::ranges::all_of(values, [](float grey) { return std::isfinite(grey); })) {
    throw ConfigError(name + ": has a value that is no finite number");
  }
  const auto [low, high] = std::ranges::minmax_element(values);
  if (*high <= 0.0F && !may_be_plain) {
    throw ConfigError(name + ": is black all over, there is nothing to compare");
  }
  if (!picture.is_float && *low >= 1.0F) {
    throw ConfigError(name + ": is at full scale all over, there is nothing to compare");
  }
  if (is_plain(result.grey) && !may_be_plain) {
    throw ConfigError(name + ": has one grey value all over, there is nothing to compare");
  }
  if (picture.is_float && *high > 1.0F) {
    scale_floats(result.grey);
    result.is_scaled = true;
  }
  return result;
}

}  // namespace glint
