// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/camera.h"

#include <algorithm>

namespace glint {

std::string_view name_of(CameraState state) {
  constexpr std::array<std::string_view, 4> kNames = {"closed", "ready", "acquiring", "lost"};
  return kNames.at(static_cast<std::size_t>(state));
}

std::string_view name_of(FrameStatus status) {
  constexpr std::array<std::string_view, 5> kNames = {
      "complete", "incomplete", "timeout", "refused", "lost"};
  return kNames.at(static_cast<std::size_t>(status));
}

ImageF linear_values(const Frame& frame) {
  ImageF values = ImageF::uninitialized(frame.codes.width(), frame.codes.height());
  const auto largest = static_cast<float>((1 << bits_of(frame.format)) - 1);
  std::ranges::transform(frame.codes.values(), values.values().begin(), [&](std::uint16_t value) {
    return static_cast<float>(value) / largest;
  });
  return values;
}

}  // namespace glint
