// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "core/error.h"

namespace glint {

/// A single-channel picture, height rows x width columns, row-major; pixel (0, 0) is top left.
template <class T>
class Image {
 public:
  Image() = default;

  Image(int width_px, int height_px, T value = {})
      : width_(width_px),
        height_(height_px),
        values_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), value) {}

  int width() const { return width_; }

  int height() const { return height_; }

  std::size_t size() const { return values_.size(); }

  bool empty() const { return values_.empty(); }

  T& operator()(int x, int y) { return values_[index(x, y)]; }

  const T& operator()(int x, int y) const { return values_[index(x, y)]; }

  T* row(int y) { return values_.data() + index(0, y); }

  const T* row(int y) const { return values_.data() + index(0, y); }

  std::vector<T>& values() { return values_; }

  const std::vector<T>& values() const { return values_; }

  friend bool operator==(const Image&, const Image&) = default;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<T> values_;
};

using ImageF = Image<float>;
using Mask = Image<unsigned char>;  ///< 0 outside, 1 inside

}  // namespace glint
