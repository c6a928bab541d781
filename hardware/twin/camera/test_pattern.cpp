// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/camera/test_pattern.h"

#include <algorithm>

namespace glint {
namespace {

std::uint16_t wrapped(unsigned value, unsigned mask) {
  return static_cast<std::uint16_t>(value & mask);
}

/// Modulo 2^16, of which 2^bits is a divisor.
Image<std::uint16_t> first_pattern(int width_px, int height_px) {
  auto image = Image<std::uint16_t>::uninitialized(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const auto column = static_cast<unsigned>(x);
      const auto row = static_cast<unsigned>(y);
      image(x, y) = wrapped(3 * column + 5 * row + column * row % 251 + 1, 0xffffU);
    }
  }
  return image;
}

Image<std::uint16_t> numbered(const Image<std::uint16_t>& first, int bits, std::uint64_t number) {
  auto image = Image<std::uint16_t>::uninitialized(first.width(), first.height());
  const unsigned mask = (1U << static_cast<unsigned>(bits)) - 1U;
  const auto step = static_cast<unsigned>((7 * number) & 0xffffU);
  std::ranges::transform(first.values(), image.values().begin(), [=](std::uint16_t value) {
    return wrapped(value + step, mask);
  });
  return image;
}

}  // namespace

Image<std::uint16_t> test_pattern(int width_px, int height_px, int bits, std::uint64_t number) {
  return numbered(first_pattern(width_px, height_px), bits, number);
}

SensorPicture TestPatternSource::finished(const CaptureSettings& settings, std::uint64_t shot) {
  if (first_.empty()) {
    first_ = first_pattern(width_px_, height_px_);
  }
  return std::make_shared<const Image<std::uint16_t>>(numbered(first_, settings.bits, shot));
}

}  // namespace glint
