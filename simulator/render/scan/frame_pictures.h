// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/image/image.h"
#include "simulator/sensor/sensor.h"

namespace glint {

/// Pictures that the frames of a scan are made in. What they hold, and of what size, does not
/// matter to the next scan.
struct FramePictures {
  std::vector<ImageF> radiance;
  ImageF grey;
  ScanSums sums;
};

/// Pictures for use again: to clear new ones takes longer than to render a small share of their
/// pixels. Safe to share between threads; as many are kept as were in use at once.
class FramePicturePool {
 public:
  std::unique_ptr<FramePictures> take() {
    const std::scoped_lock lock(mutex_);
    if (free_.empty()) {
      return std::make_unique<FramePictures>();
    }
    auto pictures = std::move(free_.back());
    free_.pop_back();
    return pictures;
  }

  void give_back(std::unique_ptr<FramePictures> pictures) {
    const std::scoped_lock lock(mutex_);
    free_.push_back(std::move(pictures));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<FramePictures>> free_;
};

}  // namespace glint
