// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/picture_levels.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

namespace glint {
namespace {

/// What a code is multiplied by: the largest one becomes 1.
template <class Code>
float grey_per_code() {
  if constexpr (std::is_integral_v<Code>) {
    return 1.0F / static_cast<float>(std::numeric_limits<Code>::max());
  } else {
    return 1.0F;
  }
}

/// Sums of integers are integers, so that the compiler may add several at a time.
template <class Code>
using Sum = std::conditional_t<std::is_integral_v<Code>, std::uint32_t, float>;

/// Means of factor x factor pixels.
template <class Code>
ImageF means(const Image<Code>& image, int factor) {
  const int width = image.width() / factor;
  const int height = image.height() / factor;
  ImageF result = ImageF::uninitialized(width, height);
  const float scale = grey_per_code<Code>() / static_cast<float>(factor * factor);
  std::vector<Sum<Code>> columns(static_cast<std::size_t>(width * factor));
  for (int y = 0; y < height; ++y) {
    std::ranges::fill(columns, Sum<Code>{0});
    for (int k = 0; k < factor; ++k) {
      const Code* row = image.row(y * factor + k);
      for (std::size_t x = 0; x < columns.size(); ++x) {
        columns[x] += row[x];
      }
    }
    float* out = result.row(y);
    const Sum<Code>* in = columns.data();
    for (int x = 0; x < width; ++x, in += factor) {
      Sum<Code> sum = 0;
      for (int k = 0; k < factor; ++k) {
        sum += in[k];
      }
      out[x] = static_cast<float>(sum) * scale;
    }
  }
  return result;
}

template <class Code>
ImageF converted(const Image<Code>& image, int x0, int y0, int width, int height) {
  ImageF result = ImageF::uninitialized(width, height);
  for (int y = 0; y < height; ++y) {
    const Code* in = image.row(y0 + y) + x0;
    std::transform(in, in + width, result.row(y), [](Code code) {
      return static_cast<float>(code) * grey_per_code<Code>();
    });
  }
  return result;
}

}  // namespace

PictureLevels::PictureLevels(const Pixels& picture) : picture_(picture) {
  std::visit(
      [this](const auto& image) {
        width_ = image.width();
        height_ = image.height();
      },
      picture_);
  // A sensor of 12 bits may be stored in 16, shifted up: its largest code is a little below 1.
  clipped_value_ = std::holds_alternative<Image<std::uint8_t>>(picture_) ? 254.5 / 255.0 : 0.9997;
}

ImageF PictureLevels::reduced(int n) {
  return std::visit([n](const auto& image) { return means(image, 1 << n); }, picture_);
}

const ImageF& PictureLevels::level(int n) {
  if (n == 0 && std::holds_alternative<ImageF>(picture_)) {
    return std::get<ImageF>(picture_);
  }
  const auto index = static_cast<std::size_t>(n);
  while (levels_.size() <= index) {
    levels_.emplace_back();
  }
  if (levels_[index].empty()) {
    // Of a finer level that is there already, else of the picture.
    levels_[index] =
        n > 1 && !levels_[index - 1].empty() ? means(levels_[index - 1], 2) : reduced(n);
  }
  return levels_[index];
}

ImageF PictureLevels::part(int n, int x, int y, int width, int height) {
  if (n == 0) {
    return std::visit([&](const auto& image) { return converted(image, x, y, width, height); },
                      picture_);
  }
  return converted(level(n), x, y, width, height);
}

}  // namespace glint
