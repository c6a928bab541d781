// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/trigger_ids.h"

namespace glint {
namespace {

constexpr std::uint64_t kLargestShortId = 65535;

bool is_short(std::uint64_t id) {
  return id <= kLargestShortId;
}

std::uint64_t next_id(std::uint64_t id) {
  return id == kLargestShortId ? 1 : id + 1;
}

}  // namespace

void TriggerIds::triggered() {
  if (expected_) {
    expected_ = next_id(*expected_);
  } else {
    ++triggers_;
  }
}

FrameAge TriggerIds::judge(std::uint64_t frame_id) {
  if (!expected_) {
    if (triggers_ > 1) {
      // The first pictures of a stream were missed; this one is of any of its triggers.
      return FrameAge::kAhead;
    }
    expected_ = frame_id;
    return FrameAge::kOfThisTrigger;
  }
  if (*expected_ == 1 && frame_id == kLargestShortId + 1) {
    expected_ = frame_id;  // ids of 64 bits do not begin again
  }
  if (frame_id == *expected_) {
    return FrameAge::kOfThisTrigger;
  }
  if (is_short(frame_id) && is_short(*expected_)) {
    const std::uint64_t behind = (*expected_ + kLargestShortId - frame_id) % kLargestShortId;
    return behind <= kLargestShortId / 2 ? FrameAge::kLate : FrameAge::kAhead;
  }
  return frame_id < *expected_ ? FrameAge::kLate : FrameAge::kAhead;
}

}  // namespace glint
