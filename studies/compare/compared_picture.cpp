// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/compared_picture.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/image/image_io.h"

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

}  // namespace

ComparedPicture read_compared(const CompareSource& source) {
  const std::string name = source.picture.string();
  const Picture picture = read_picture(source.picture);
  ComparedPicture result = {.source = source,
                            .grey = linear_values(picture.pixels),
                            .bits = picture.bits,
                            .is_float = picture.is_float,
                            .channels = picture.channels};
  const auto& values = result.grey.values();
  if (!std::ranges::all_of(values, [](float grey) { return std::isfinite(grey); })) {
    throw ConfigError(name + ": has a value that is no finite number");
  }
  const auto [low, high] = std::ranges::minmax_element(values);
  if (*high <= 0.0F) {
    throw ConfigError(name + ": is black all over, there is nothing to compare");
  }
  if (!picture.is_float && *low >= 1.0F) {
    throw ConfigError(name + ": is at full scale all over, there is nothing to compare");
  }
  if (*high - *low <= 0.0F) {
    throw ConfigError(name + ": has one grey value all over, there is nothing to compare");
  }
  if (picture.is_float && *high > 1.0F) {
    scale_floats(result.grey);
  }
  return result;
}

}  // namespace glint
