// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/error.h"
#include "core/image/uninitialized_allocator.h"

namespace glint {

/// A single-channel picture, height rows x width columns, row-major; pixel (0, 0) is top left.
template <class T>
class Image {
 public:
  using Values = std::vector<T, UninitializedAllocator<T>>;

  Image() = default;

  Image(int width_px, int height_px, T value = {}) : Image(uninitialized(width_px, height_px)) {
    std::fill(values_.begin(), values_.end(), value);
  }

  /// Vectors with an allocator of their own copy one element after another.
  Image(const Image& other) : Image(uninitialized(other.width_, other.height_)) {
    std::copy(other.values_.begin(), other.values_.end(), values_.begin());
  }

  Image& operator=(const Image& other) {
    if (this != &other) {
      width_ = other.width_;
      height_ = other.height_;
      values_.resize(other.size());
      std::copy(other.values_.begin(), other.values_.end(), values_.begin());
    }
    return *this;
  }

  Image(Image&&) noexcept = default;
  Image& operator=(Image&&) noexcept = default;
  ~Image() = default;

  /// A picture whose values are whatever was in memory: each must be written before it is read.
  static Image uninitialized(int width_px, int height_px) {
    Image image;
    image.width_ = width_px;
    image.height_ = height_px;
    image.values_.resize(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
    return image;
  }

  int width() const { return width_; }

  int height() const { return height_; }

  std::size_t size() const { return values_.size(); }

  bool empty() const { return values_.empty(); }

  T& operator()(int x, int y) { return values_[index(x, y)]; }

  const T& operator()(int x, int y) const { return values_[index(x, y)]; }

  T* row(int y) { return values_.data() + index(0, y); }

  const T* row(int y) const { return values_.data() + index(0, y); }

  Values& values() { return values_; }

  const Values& values() const { return values_; }

  friend bool operator==(const Image&, const Image&) = default;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  int width_ = 0;
  int height_ = 0;
  Values values_;
};

using ImageF = Image<float>;
using Mask = Image<unsigned char>;  ///< 0 outside, 1 inside

}  // namespace glint
