// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "core/image/image.h"

namespace glint {

/// Pictures of one size for use again: fetching fresh memory takes longer than filtering it. Safe
/// to share between threads.
class PicturePool {
 public:
  PicturePool(int width_px, int height_px) : width_px_(width_px), height_px_(height_px) {}

  /// A picture with anything in it.
  ImageF take() {
    const std::scoped_lock lock(mutex_);
    if (free_.empty()) {
      return {width_px_, height_px_};
    }
    ImageF picture = std::move(free_.back());
    free_.pop_back();
    return picture;
  }

  void give_back(ImageF&& picture) {
    const std::scoped_lock lock(mutex_);
    free_.push_back(std::move(picture));
  }

 private:
  int width_px_;
  int height_px_;
  std::mutex mutex_;
  std::vector<ImageF> free_;
};

}  // namespace glint
